// The control lobes of a scene's materials as curves over the viewer's cosine. They are for shaders that
// cannot evaluate the BSDFs.
#pragma once

#include <vector>

#include "kernels/host/device_scene.h"

namespace penumbra {

/// A control lobe at one cosine. Between two knots the lobe is linear in the square root of the cosine;
/// colours are nearly linear in the cosine.
struct ControlKnot {
  vec3 diffuse;
  /// Together with the widths: arguments of make_ltc (kernels/bsdf/ltc.h) for a roughness of 1/2.
  float lean;
  vec3 specular;
  float width_x;  ///< 0 or less: there is no lobe
  float width_y;
};

/// The number of knots per material, at the cosines (j / (kControlKnots - 1))^2. They include the columns of
/// the LTC table.
constexpr int kControlKnots = 4 * (LTC_SIZE - 1) + 1;

/// The knots of all materials. Textured colours are replaced by their constant values. Empty without
/// FEATURE_LTC.
std::vector<ControlKnot> control_knots(const DeviceScene& scene);

}  // namespace penumbra
