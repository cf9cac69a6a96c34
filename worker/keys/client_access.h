// The credentials of clients of a scheduler.
#pragma once

#include <memory>
#include <string>

#include "kernels/host/error.h"
#include "worker/keys/key_folder.h"

namespace penumbra {

/// Environment variables that contain a token, or the path of a folder of keys.
inline constexpr const char* kTokenVariable = "PENUMBRA_TOKEN";
inline constexpr const char* kKeysVariable = "PENUMBRA_KEYS";

/// A client's credentials. Over a Unix socket neither is needed.
struct ClientAccess {
  std::string token = {};
  std::shared_ptr<const Keys> keys = {};  ///< if set, the connection is encrypted
};

/// Error: the address is on another host and there are no keys, so that the token would be sent unencrypted.
Expected<void> check_encrypted(const std::string& address, const Keys* keys, KeyRole role);

/// The credentials for a connection to `address` ("unix:/path", "host:port" or "file:path"): the keys of
/// `folder`, or if that is empty the token of the environment. The token is then removed from this process's
/// environment, so that no child inherits it. Errors: those of read_keys and of check_encrypted; for
/// "file:path" the latter must be called with what is read from the file.
Expected<ClientAccess> client_access(const std::string& address, const std::string& folder, KeyRole role);

}  // namespace penumbra
