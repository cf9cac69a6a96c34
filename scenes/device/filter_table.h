// Inverse-distribution tables of reconstruction filters, see kernels/sampler/filter.h.
#pragma once

#include <vector>

#include "scenes/scene_description.h"

namespace penumbra {

/// The unnormalised filter value at `x` filter radii from the centre, |x| <= 1.
double filter_value(const Film& film, double x);

/// FILTER_CELLS + 1 knots from the centre, 0, to the radius, 1, and the weights of the cells between them, as
/// sample_filter reads them. The weights average to 1 over the samples.
std::vector<float> filter_table(const Film& film);

}  // namespace penumbra
