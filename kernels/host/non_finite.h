// Non-finite samples: how many of a kind, and where the first of them is.
#pragma once

#include <compare>
#include <cstdint>
#include <string_view>

#include "kernels/unit.h"

namespace penumbra {

/// Where a path first held a non-finite value.
struct NonFiniteSource {
  int where = SOURCE_UNKNOWN;  ///< SOURCE_*
  int step = 0;                ///< of the integrator, from 0: the bounce

  friend auto operator<=>(const NonFiniteSource&, const NonFiniteSource&) = default;
};

/// "camera ray", "light sample", ... for a SOURCE_*.
std::string_view source_name(int source);

/// Samples of one kind, NaN or infinite; they count as 0 radiance. The first is that of the first row, in it
/// of the first column, in that pixel of the lowest index.
struct NonFiniteSamples {
  std::uint64_t count = 0;
  int x = 0, y = 0;             ///< film pixel of the first; means nothing where there is none, as the rest
  std::uint32_t sample = 0;     ///< its index
  NonFiniteSource source = {};  ///< where it first held the value

  /// Adds others, in any order.
  void add(const NonFiniteSamples& others);

  friend bool operator==(const NonFiniteSamples&, const NonFiniteSamples&) = default;
};

/// From the counts of a block, with pixels and indices of the unit, to those of the film.
NonFiniteSamples non_finite_samples(const Unit& unit, const BadSamples& bad);

}  // namespace penumbra
