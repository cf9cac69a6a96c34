// How bright skies are.
#pragma once

#include <glm/glm.hpp>

namespace penumbra {

/// By what Preetham's sky is to be multiplied, channel by channel, so that its irradiance on the ground is
/// that of Hosek and Wilkie's model (2012, An analytic model for full spectral sky-dome radiance), which
/// Mitsuba 0.6 and 3 have: measured of Mitsuba 3.9's sunsky for each whole turbidity from 1 to 10, 13
/// elevations of the sun, and grounds of albedo 0 and 1; linear between them. `elevation`: the sun's,
/// degrees.
glm::dvec3 sky_level(double turbidity, double elevation, const glm::dvec3& albedo);

}  // namespace penumbra
