// Inverse-distribution tables of reconstruction filters, see kernels/filter.h.
#pragma once

#include <vector>

#include "scenes/scene_description.h"

namespace penumbra {

/// The unnormalised filter value at `x` filter radii from the centre, |x| <= 1.
double filter_value(const Film& film, double x);

/// FILTER_CELLS + 1 knots in [-1, 1] between which |f| has equal mass, then for each cell its mass of f relative to the
/// mean cell's, so that the weights average to 1.
std::vector<float> filter_table(const Film& film);

}  // namespace penumbra
