// Samples that are not as they should be: how many of a kind, and where the first of them is.
#pragma once

#include <array>
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

/// Samples of one kind; those that are not finite count as 0 radiance. The first is that of the first row, in
/// it of the first column, in that pixel of the lowest index.
struct FlaggedSamples {
  std::uint64_t count = 0;
  int x = 0, y = 0;             ///< film pixel of the first; means nothing where there is none, as the rest
  std::uint32_t sample = 0;     ///< its index
  NonFiniteSource source = {};  ///< where it first held the value, if it is not finite
  int shape = 0;                ///< of BAD_BOUNDARY: whose boundary it met, see boundary_names

  /// Adds others, in any order.
  void add(const FlaggedSamples& others);

  friend bool operator==(const FlaggedSamples&, const FlaggedSamples&) = default;
};

/// Whether a kernel can have found its source and shape; where they are is for those to check who know the
/// pixels.
bool is_possible(const FlaggedSamples& samples);

/// Those of every kind, BAD_*.
using FlaggedByKind = std::array<FlaggedSamples, BAD_KINDS>;

/// Adds others, kind by kind.
void add(FlaggedByKind& to, const FlaggedByKind& others);

/// How many there are that are not finite.
std::uint64_t non_finite_count(const FlaggedByKind& flagged);

/// From the counts of a block, with pixels and indices of the unit, to those of the film.
FlaggedSamples flagged_samples(const Unit& unit, const BadSamples& bad);

}  // namespace penumbra
