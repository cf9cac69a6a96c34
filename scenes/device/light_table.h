// Probabilities of choosing among lights.
#pragma once

#include <span>
#include <vector>

#include "kernels/scene_types.h"

namespace penumbra {

/// Sets `pmf` and the alias table (Walker 1977, Vose 1991) of each light so that it is chosen in proportion
/// to its power; `power` has one entry a light, at least one of them positive.
void set_light_probabilities(std::span<Light> lights, std::span<const double> power);

}  // namespace penumbra
