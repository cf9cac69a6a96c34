// Access control of a scheduler. A Unix socket is protected by its file permissions. TCP connections need a
// token, and those from other hosts encryption and certificates too.
#pragma once

#include <grpcpp/security/server_credentials.h>

#include <memory>
#include <string>
#include <string_view>

#include "kernels/host/error.h"
#include "scheduler/keys/key_folder.h"
#include "scheduler/keys/secrets.h"
#include "scheduler/keys/tcp_address.h"

namespace penumbra {

/// The path of "unix:path".
std::string unix_path(const std::string& address);

/// Fails unless it is "unix:/path", or host and port: of this host itself ("127.0.0.1:0", "[::1]:7000",
/// "localhost:7000"); with keys of any of its addresses and names, "0.0.0.0:7000" and "[::]:7000" for all.
Expected<void> check_listen_address(const std::string& address, bool has_keys = false);

/// The keys of a scheduler that listens there, from the folder; null without one, or for a Unix socket.
/// Fails as check_listen_address and read_keys do.
Expected<std::shared_ptr<const Keys>> listening_keys(const std::string& address, const std::string& folder);

/// Where clients on other hosts reach it: for "0.0.0.0" and "[::]" this host's name.
std::string reachable_address(const std::string& address);

/// For a TCP port. With keys connections are encrypted, and clients show certificates of the same authority.
/// A call is checked once its metadata have arrived and before any message is read: UNAUTHENTICATED without
/// one of the tokens, PERMISSION_DENIED where the token does not permit this call. Without keys: for
/// connections within this host.
std::shared_ptr<grpc::ServerCredentials> token_credentials(const Tokens& tokens, const Keys* keys = nullptr);

}  // namespace penumbra
