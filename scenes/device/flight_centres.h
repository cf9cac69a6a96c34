// Places from where the lights of a scene shine on its media.
#pragma once

#include <span>
#include <vector>

#include "scenes/device/light_bounds.h"

namespace penumbra {

/// Of all lights that are somewhere, in few groups of such as are near each other; chosen as often as they
/// are strong.
std::vector<FlightCentre> flight_centres(std::span<const LightBounds> lights);

}  // namespace penumbra
