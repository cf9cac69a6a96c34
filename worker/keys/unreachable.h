// Finds out why a connection to a scheduler fails, which gRPC does not report.
#pragma once

#include <chrono>
#include <string>

#include "worker/keys/key_folder.h"

namespace penumbra {

/// The reason if there is no server at the address.
constexpr const char* kNobodyListens = "nobody listens there";

/// Connects to "host:port" or "unix:/path" like a client with these keys (null: without) and describes the
/// failure: unknown host, nobody listens, no right to a socket, another program, TLS missing at one end,
/// which certificate is wrong and why. Empty if no cause is found. `patience` limits the time for each of:
/// connecting, the handshake, an answer.
std::string why_unreachable(const std::string& address, const Keys* keys, std::chrono::milliseconds patience);

}  // namespace penumbra
