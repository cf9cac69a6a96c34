// The table of a measured BRDF for the kernels.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scenes/measured_file.h"

namespace penumbra {

/// The albedo at the polar angle nearest to 45 degrees, in [1e-4, 1], for layers of albedos.
glm::vec3 measured_albedo(const MeasuredBrdf& brdf);

/// The numbers of kernels/bsdf/measured.h, of at least CURVE_STRIDE. Densities become those of area 1; one
/// that is 0 everywhere is even. Colours are over measured_albedo().
std::vector<float> measured_table(const MeasuredBrdf& brdf);

}  // namespace penumbra
