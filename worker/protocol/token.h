// How a client authenticates to a scheduler over TCP, and how a worker proves that the scheduler started it.
#pragma once

#include <string>

namespace penumbra {

inline constexpr const char* kTokenKey = "authorization";  ///< key in the call's metadata
/// The environment variable in which a scheduler passes a worker process its key; see Hello.key.
inline constexpr const char* kWorkerKeyVariable = "PENUMBRA_WORKER_KEY";
inline std::string token_metadata(const std::string& token) { return "Bearer " + token; }

}  // namespace penumbra
