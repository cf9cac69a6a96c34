// The control lobes of a scene's materials as curves over the viewer's cosine, for shaders, which have none
// of the BSDFs.
#pragma once

#include <vector>

#include "kernels/host/device_scene.h"

namespace penumbra {

/// At one cosine; what is between two is linear in the cosine's root, colours nearly so in the cosine.
struct ControlKnot {
  vec3 diffuse;
  float lean;  ///< with the widths: arguments of make_ltc (kernels/bsdf/ltc.h) for a roughness of 1/2
  vec3 specular;
  float width_x;  ///< 0 or less: there is no lobe
  float width_y;
};

/// As many for each material, at the cosines (j / (kControlKnots - 1))^2: those of the table's columns among
/// them.
constexpr int kControlKnots = 4 * (LTC_SIZE - 1) + 1;

/// Of all materials, colours that have textures as if they had none. Empty without FEATURE_LTC.
std::vector<ControlKnot> control_knots(const DeviceScene& scene);

}  // namespace penumbra
