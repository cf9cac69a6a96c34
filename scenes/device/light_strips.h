// Outlines of flat lights as kernels sample them (kernels/light/outline_light.h).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/device/polygon_outline.h"

namespace penumbra {

struct AreaLightStrips {
  /// A corner, the next and the previous one, of a rectangle about the outline. It is parallel to the
  /// outline's plane and before all corners by some roundings of theirs, so that the light's own triangles do
  /// not hide it.
  std::array<vec3, 3> rectangle;
  std::vector<LightStrip> strips;  ///< the first starts at 0
};

/// The outline's strips along the edge, of its longest ones, along which they are fewest. Nothing if they
/// were more than MOST_LIGHT_STRIPS, if it overlaps itself, or without an area. Their area is the outline's
/// within 1e-5 of it: corners that are within 1e-6 of the rectangle's height of a line are taken to be on it.
std::optional<AreaLightStrips> strips_of(const Outline& outline);

}  // namespace penumbra
