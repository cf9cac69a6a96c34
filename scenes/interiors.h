// The media inside of surfaces that follow from their materials.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenes/scene_description.h"

namespace penumbra {

struct Interior {
  ParticipatingMedium medium;  ///< homogeneous
  /// Light goes in and out evenly, instead of by refraction.
  bool walks = false;
  /// The medium's albedo is 1; the path's follows the colour of the surface where it went in.
  bool by_colour = false;
};

/// What the BSDF of that index has inside, by its InnerMedium or its parameters: the first that it holds
/// decides.
///
/// Subsurface scattering has the extinction 1 / radius (OpenPBR 1.1). Its single-scattering albedo is that of
/// a half-space whose albedo is the colour (bsdfs/half_space.h); a radius of 0 is 1e-6 of the largest. Of
/// what transmits with a depth the extinction is -log(colour) / depth, and the scattering coefficient is
/// scatter / depth; if that is larger, the absorption of all colours is raised until none is negative.
std::optional<Interior> interior_of(const SceneDescription& scene, int bsdf);

/// What the scene's integrator does not show of interiors, for warnings.
std::vector<std::string> interior_warnings(const SceneDescription& scene);

}  // namespace penumbra
