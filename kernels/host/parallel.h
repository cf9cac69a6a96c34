// A loop over independent items on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace penumbra {

inline std::size_t core_count() { return std::max(1u, std::thread::hardware_concurrency()); }

/// Calls body(i) once for each i < count, on at most `threads` threads, of which the caller's is one. It must
/// not throw. Threads take the next item when they are done with one.
template <typename Body>
void in_parallel(std::size_t count, std::size_t threads, const Body& body) {
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) body(i);
  };
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < std::min(threads, count); ++i) others.emplace_back(work);
  work();
}

}  // namespace penumbra
