// Who may talk to a scheduler: over a Unix socket whoever can reach its directory, over TCP on this host
// whoever knows the token. Connections of other hosts would need encryption, and are refused.
#pragma once

#include <grpcpp/server_context.h>

#include <string>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra {

/// Whether the address is "host:port" rather than "unix:path".
bool is_tcp(const std::string& address);

/// Whether the text is a port's number, 0 to 65535.
bool is_port(std::string_view text);

/// Fails unless it is "unix:/path" or an address and port of this host itself ("127.0.0.1:0", "[::1]:7000",
/// "localhost:7000").
Expected<void> check_listen_address(const std::string& address);

/// Whether somebody listens at "unix:/path" already: a socket's file that is left over from a process that
/// died does not count.
bool is_answered(const std::string& address);

/// "host:0" with the port that was chosen.
std::string with_port(const std::string& address, int port);

/// 128 random bits as 32 hexadecimal digits.
std::string make_token();

/// OK for calls over a Unix socket and for those whose metadata hold the token; else UNAUTHENTICATED.
grpc::Status check_access(const grpc::ServerContext& context, const std::string& token);

}  // namespace penumbra
