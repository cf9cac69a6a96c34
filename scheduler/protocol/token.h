// How a client shows that it may talk to a scheduler over TCP.
#pragma once

#include <string>

namespace penumbra {

inline constexpr const char* kTokenKey = "authorization";  ///< of the call's metadata
inline std::string token_metadata(const std::string& token) { return "Bearer " + token; }

}  // namespace penumbra
