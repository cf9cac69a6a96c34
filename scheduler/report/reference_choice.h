// Which truth a report renders for itself: two halves with seeds of their own, by other means than the
// methods that they judge where that is possible.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/integrators.h"

namespace penumbra {

/// What an integrator's image tends to, in words: equal texts are equal images in the limit.
std::string estimated_quantity(const IntegratorSettings& integrator);

struct ReferenceMethod {
  std::string integrator;
  std::vector<std::string> settings;  ///< for --set
  std::string sampler;
};

/// Two integrators whose images tend to the same as this one's, as different from it and from each other as
/// there are: direct light by `direct` and by paths of two edges, others by paths under two MIS heuristics;
/// one half with Owen-scrambled Sobol points, one with independent samples.
std::array<ReferenceMethod, 2> choose_reference(const IntegratorSettings& integrator);

/// A reference has at least this many times the samples of the largest budget, both halves together.
constexpr std::uint64_t kReferenceFactor = 50;

/// Samples of each half: half of `total`; if that is 0, of kReferenceFactor * largest_budget, rounded up to a
/// power of two, which Sobol points like.
std::uint32_t half_reference_spp(std::uint32_t largest_budget, std::uint32_t total);

}  // namespace penumbra
