// Access control of a scheduler. A Unix socket is protected by its file permissions. TCP connections need a
// token. Connections from other hosts also need TLS and certificates.
#pragma once

#include <grpcpp/security/server_credentials.h>

#include <memory>
#include <string>
#include <string_view>

#include "kernels/host/error.h"
#include "worker/keys/key_folder.h"
#include "worker/keys/secrets.h"
#include "worker/keys/tcp_address.h"

namespace penumbra {

/// The path of "unix:path".
std::string unix_path(const std::string& address);

/// Checks a listening address: "unix:/path", or host and port. Without keys it must be on the loopback
/// interface ("127.0.0.1:0", "[::1]:7000", "localhost:7000"). With keys it may be any address or name of this
/// host, or "0.0.0.0:7000" and "[::]:7000" for all of them.
Expected<void> check_listen_address(const std::string& address, bool has_keys = false);

/// Reads the keys for listening at this address from the folder. Null without a folder, or for a Unix socket.
/// Errors: those of check_listen_address and read_keys.
Expected<std::shared_ptr<const Keys>> listening_keys(const std::string& address, const std::string& folder);

/// The address at which clients on other hosts reach this one: "0.0.0.0" and "[::]" are replaced by the
/// host's name. With keys, clients accept only a host that is in the certificate: then it is the first
/// of the given host, the names of this host if it listens on all, and the certificate's names that is in it.
std::string reachable_address(const std::string& address, const Keys* keys = nullptr);

/// Credentials for a TCP port. With keys, connections are encrypted, and clients must have certificates of
/// the same authority. Without keys, they are for connections within this host. The token is checked when a
/// call's metadata arrive, before any message is read: UNAUTHENTICATED if there is no valid token,
/// PERMISSION_DENIED if the token does not permit this call.
std::shared_ptr<grpc::ServerCredentials> token_credentials(const Tokens& tokens, const Keys* keys = nullptr);

}  // namespace penumbra
