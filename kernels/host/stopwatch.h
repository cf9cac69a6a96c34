// Elapsed time.
#pragma once

#include <chrono>

namespace penumbra {

/// On the clock that is never set.
inline double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace penumbra
