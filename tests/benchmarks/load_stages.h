// Timed stages of loading a scene, with their memory.
#pragma once

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <utility>

#include "kernels/host/error.h"
#include "kernels/host/process.h"

namespace penumbra {

inline double resident_bytes() {
  constexpr double kPage = 4096;
  std::ifstream statm("/proc/self/statm");
  double total = 0, resident = 0;
  statm >> total >> resident;
  return resident * kPage;
}

inline void print_stage_heading(const char* unit) {
  fmt::print("bytes a {}:\n| stage | s | s of cores | M{}s/s | before | after | most |\n", unit, unit);
  fmt::print("|---|---|---|---|---|---|---|\n");
}

/// Runs the stage and prints its line: memory is all that the process has. Returns seconds of all cores.
template <typename Stage>
double show_stage(const std::string& name, double units, const Stage& stage) {
  // So that the most is that of this stage.
  std::ofstream("/proc/self/clear_refs") << "5";
  const double before = resident_bytes();
  const auto begin = std::chrono::steady_clock::now();
  const std::clock_t start = std::clock();
  stage();
  const double seconds = seconds_since(begin), cores = double(std::clock() - start) / CLOCKS_PER_SEC;
  fmt::print("| {} | {:.3f} | {:.3f} | {:.2f} | {:.1f} | {:.1f} | {:.1f} |\n", name, seconds, cores,
             units / seconds / 1e6, before / units, resident_bytes() / units,
             double(peak_memory_bytes()) / units);
  std::fflush(stdout);
  return cores;
}

template <typename T>
T value_or_exit(Expected<T> result) {
  if (result) return std::move(*result);
  fmt::print(stderr, "{}\n", result.error().message);
  std::exit(1);
}

}  // namespace penumbra
