// Access control of a scheduler. A Unix socket is protected by its file permissions. TCP connections from
// this host need a token. Connections from other hosts would need encryption, and are refused.
#pragma once

#include <grpcpp/security/server_credentials.h>

#include <memory>
#include <string>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra {

/// Whether the address is "host:port" rather than "unix:path".
bool is_tcp(const std::string& address);

/// What is before and after the last colon.
struct HostAndPort {
  std::string_view host, port;
};
HostAndPort split_address(std::string_view address);

/// The path of "unix:path".
std::string unix_path(const std::string& address);

/// Whether the text is a port's number, 0 to 65535.
bool is_port(std::string_view text);

/// Fails unless it is "unix:/path" or an address and port of this host itself ("127.0.0.1:0", "[::1]:7000",
/// "localhost:7000").
Expected<void> check_listen_address(const std::string& address);

/// "host:0" with the port that was chosen.
std::string with_port(const std::string& address, int port);

/// 128 random bits as 32 hexadecimal digits.
std::string make_token();

/// The tokens for calls over TCP, and the calls that each permits. A viewer's token does not permit sending
/// samples.
struct Tokens {
  std::string watch;        ///< Watch, Control, Asset; of a service's jobs Status
  std::string work;         ///< Work, Asset
  std::string submit = {};  ///< all but Work; empty where there is nothing to submit to
};

/// For a port of this host. A call is checked once its metadata have arrived and before any message is read:
/// UNAUTHENTICATED without one of the tokens, PERMISSION_DENIED where the token does not permit this call.
std::shared_ptr<grpc::ServerCredentials> token_credentials(const Tokens& tokens);

}  // namespace penumbra
