// Counts of bad samples of each kind, and where the first one is.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <string_view>

#include "kernels/unit.h"

namespace penumbra {

/// Where a path first had a non-finite value.
struct NonFiniteSource {
  int where = SOURCE_UNKNOWN;  ///< SOURCE_*
  int step = 0;                ///< step of the integrator, from 0: the bounce

  friend auto operator<=>(const NonFiniteSource&, const NonFiniteSource&) = default;
};

/// Name for users of a SOURCE_*: "camera ray", "light sample", ...
std::string_view source_name(int source);

/// Bad samples of one kind; non-finite ones count as 0 radiance. The first one is the lowest in the order
/// row, column, sample index.
struct FlaggedSamples {
  std::uint64_t count = 0;
  int x = 0, y = 0;             ///< film pixel of the first one; all fields are arbitrary if count is 0
  std::uint32_t sample = 0;     ///< its index
  NonFiniteSource source = {};  ///< where it first became non-finite
  int shape = 0;                ///< BAD_BOUNDARY: index of the contradictory shape, see boundary_names

  /// Adds other samples, in any order.
  void add(const FlaggedSamples& others);

  friend bool operator==(const FlaggedSamples&, const FlaggedSamples&) = default;
};

/// Whether a kernel can have reported this source and shape. Pixels are checked where the unit is known.
bool is_possible(const FlaggedSamples& samples);

/// Bad samples of every kind, BAD_*.
using FlaggedByKind = std::array<FlaggedSamples, BAD_KINDS>;

/// Adds others of each kind.
void add(FlaggedByKind& to, const FlaggedByKind& others);

/// Number of non-finite samples.
std::uint64_t non_finite_count(const FlaggedByKind& flagged);

/// Converts a block's counts, whose pixels and indices are relative to the unit, to film coordinates.
FlaggedSamples flagged_samples(const Unit& unit, const BadSamples& bad);

}  // namespace penumbra
