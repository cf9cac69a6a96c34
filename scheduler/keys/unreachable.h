// Why there is no connection to a scheduler, which gRPC does not say.
#pragma once

#include <chrono>
#include <string>

#include "scheduler/keys/key_folder.h"

namespace penumbra {

/// Connects to "host:port" by itself, as a client with these keys does (null: one without), and says in words
/// where that ends: no such host, nobody listens, no TLS at one of the ends, whose certificate is wrong and
/// how. Empty if nothing is found. Takes at most about `patience` for each of: connecting, the handshake, an
/// answer.
std::string why_unreachable(const std::string& address, const Keys* keys, std::chrono::milliseconds patience);

}  // namespace penumbra
