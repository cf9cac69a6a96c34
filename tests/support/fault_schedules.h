// How many random fault schedules a test runs, and with which seeds.
#pragma once

#include <cstdlib>
#include <vector>

namespace penumbra {

/// Seeds from 1 on: `usual` of them; PENUMBRA_FAULT_FACTOR times as many in a long run; PENUMBRA_FAULT_SEED
/// alone where that is set, to repeat what has failed.
inline std::vector<unsigned> fault_seeds(unsigned usual) {
  if (const char* seed = std::getenv("PENUMBRA_FAULT_SEED"))
    return {unsigned(std::strtoul(seed, nullptr, 10))};
  const char* factor = std::getenv("PENUMBRA_FAULT_FACTOR");
  const unsigned count = usual * (factor == nullptr ? 1 : unsigned(std::strtoul(factor, nullptr, 10)));
  std::vector<unsigned> seeds;
  for (unsigned seed = 1; seed <= count; ++seed) seeds.push_back(seed);
  return seeds;
}

}  // namespace penumbra
