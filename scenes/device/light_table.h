// The table by which lights are chosen in proportion to their power.
#pragma once

#include <span>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/device/light_bounds.h"

namespace penumbra {

/// Returns the cells of the table (choose_light): each holds the index of a light. Sets `pmf` and `start` of
/// the lights. A light has an integer number of adjacent cells, and at least one if it has power; so weak
/// lights are chosen somewhat too often, which their `pmf` accounts for. Lights are ordered along a
/// space-filling curve, so that well-distributed random numbers give well-distributed points, even on the
/// parts of one light. `power` and `bounds` have one entry per light, and at least one power is positive.
std::vector<int> set_light_probabilities(std::span<Light> lights, std::span<const double> power,
                                         std::span<const LightBounds> bounds);

}  // namespace penumbra
