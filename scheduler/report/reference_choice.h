// Chooses how a report renders its own reference: two halves with different seeds, if possible by other
// integrators than those that are judged.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/integrators.h"

namespace penumbra {

/// A description of the limit image of an integrator. Equal texts mean equal images in the limit.
std::string estimated_quantity(const IntegratorSettings& integrator);

struct ReferenceMethod {
  std::string integrator;
  std::vector<std::string> settings;  ///< for --set
  std::string sampler;
};

/// Two methods with the same limit image as this integrator, as different from it and from each other as
/// possible. Direct illumination is rendered by `direct` and by paths of two edges, other light transport by
/// paths with two different MIS heuristics. One half uses Owen-scrambled Sobol points, the other independent
/// samples.
std::array<ReferenceMethod, 2> choose_reference(const IntegratorSettings& integrator);

/// A reference has at least this many times the samples of the largest budget, counting both halves.
constexpr std::uint64_t kReferenceFactor = 50;

/// Samples per pixel of each half: half of `total`, or if that is 0, of kReferenceFactor * largest_budget,
/// rounded up to a power of two, which suits Sobol points.
std::uint32_t half_reference_spp(std::uint32_t largest_budget, std::uint32_t total);

}  // namespace penumbra
