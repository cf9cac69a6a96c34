// The credentials of clients of a scheduler.
#pragma once

#include <memory>
#include <string>

#include "kernels/host/error.h"
#include "scheduler/keys/key_folder.h"

namespace penumbra {

/// Environment variables that contain a token, or the path of a folder of keys.
inline constexpr const char* kTokenVariable = "PENUMBRA_TOKEN";
inline constexpr const char* kKeysVariable = "PENUMBRA_KEYS";

/// A client's credentials. Over a Unix socket neither is needed.
struct ClientAccess {
  std::string token = {};
  std::shared_ptr<const Keys> keys = {};  ///< if set, the connection is encrypted
};

/// The credentials for a connection to `address` ("unix:/path" or "host:port"): the keys of `folder`, or if
/// that is empty the token of the environment. The token is then removed from this process's environment, so
/// that no child inherits it. Errors: those of read_keys; a scheduler on another host without keys, because
/// the token would be sent unencrypted.
Expected<ClientAccess> client_access(const std::string& address, const std::string& folder, KeyRole role);

}  // namespace penumbra
