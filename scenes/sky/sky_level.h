// The brightness of skies.
#pragma once

#include <glm/glm.hpp>

namespace penumbra {

/// The factor for each channel by which to multiply Preetham's sky so that its irradiance on the ground is
/// that of the model of Hosek and Wilkie (2012, An analytic model for full spectral sky-dome radiance), which
/// Mitsuba 0.6 and 3 use. The factors were measured with Mitsuba 3.9's sunsky, for integer turbidities from 1
/// to 10, 13 elevations of the sun, and ground albedos 0 and 1; they are interpolated linearly. `elevation`
/// is the sun's, in degrees.
glm::dvec3 sky_level(double turbidity, double elevation, const glm::dvec3& albedo);

}  // namespace penumbra
