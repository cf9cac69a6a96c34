// Probabilities of choosing among lights.
#pragma once

#include <span>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/device/light_bounds.h"

namespace penumbra {

/// The cells of the table by which each light is chosen in proportion to its power (choose_light), of each
/// its light; sets `pmf` and `start` of the lights. A light has a whole number of neighbouring cells, one at
/// least if it has power, so that small ones are chosen somewhat more often than they should be. Their order
/// is that of the lights' places along a curve through space: points that are well spread over the numbers
/// are so over lights that are parts of one light, too. `power` and `bounds` have one entry a light, at least
/// one power is positive.
std::vector<int> set_light_probabilities(std::span<Light> lights, std::span<const double> power,
                                         std::span<const LightBounds> bounds);

}  // namespace penumbra
