// How every client of a scheduler proves that it may talk.
#pragma once

#include <memory>
#include <string>

#include "kernels/host/error.h"
#include "scheduler/keys/key_folder.h"

namespace penumbra {

/// The environment variables from which programs read secrets, or where they are.
inline constexpr const char* kTokenVariable = "PENUMBRA_TOKEN";
inline constexpr const char* kKeysVariable = "PENUMBRA_KEYS";

/// What a client shows. Over a Unix socket neither is needed.
struct ClientAccess {
  std::string token = {};
  std::shared_ptr<const Keys> keys = {};  ///< with them the connection is encrypted
};

/// For a connection to `address` ("unix:/path" or "host:port"): the keys of `folder`, or where that is empty
/// the token of the environment, which this process then forgets, so that no child inherits it. Errors: those
/// of read_keys; a scheduler on another host without keys, since the token would travel for all to read.
Expected<ClientAccess> client_access(const std::string& address, const std::string& folder, KeyRole role);

}  // namespace penumbra
