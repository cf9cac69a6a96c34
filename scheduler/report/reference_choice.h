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
/// `has_media`: the scene has media that the integrator sees. A biased integrator counts as the one that it
/// approximates, so that the difference is its bias.
std::string estimated_quantity(const IntegratorSettings& integrator, bool has_media = false);

struct ReferenceMethod {
  std::string integrator;
  std::vector<std::string> settings;  ///< for --set
  std::string sampler;
};
using ReferencePair = std::array<ReferenceMethod, 2>;

/// Two methods with the same limit image as this integrator, as different from it and from each other as
/// possible. Direct illumination is rendered by `direct` and by paths of two edges, other light transport by
/// paths, in media by volpath, with two different MIS heuristics. One half uses Owen-scrambled Sobol points,
/// the other independent samples.
ReferencePair choose_reference(const IntegratorSettings& integrator, bool has_media = false);

/// A reference has at least this many times the samples of the largest budget, counting both halves.
constexpr std::uint64_t kReferenceFactor = 50;

/// Samples per pixel of each half: half of `total`, or if that is 0, of kReferenceFactor * largest_budget,
/// rounded up to a power of two, which suits Sobol points.
std::uint32_t half_reference_spp(std::uint32_t largest_budget, std::uint32_t total);

}  // namespace penumbra
