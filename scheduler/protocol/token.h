// How a client shows that it may talk to a scheduler over TCP, and a worker that the scheduler started it.
#pragma once

#include <string>

namespace penumbra {

inline constexpr const char* kTokenKey = "authorization";  ///< of the call's metadata
/// The environment variable from which people's programs take it.
inline constexpr const char* kTokenVariable = "PENUMBRA_TOKEN";
/// That in which a scheduler tells each worker process that it starts who it is, see Hello.key.
inline constexpr const char* kWorkerKeyVariable = "PENUMBRA_WORKER_KEY";
inline std::string token_metadata(const std::string& token) { return "Bearer " + token; }

}  // namespace penumbra
