// Centres of light clusters, for sampling distances along rays in media.
#pragma once

#include <span>
#include <vector>

#include "scenes/device/light_bounds.h"

namespace penumbra {

/// Clusters all lights that have a position into a few groups of nearby lights. The probability of a centre
/// is proportional to the power of its group.
std::vector<FlightCentre> flight_centres(std::span<const LightBounds> lights);

}  // namespace penumbra
