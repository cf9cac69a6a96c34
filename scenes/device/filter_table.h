// Tables of the inverse distribution functions of reconstruction filters; see kernels/sampler/filter.h.
#pragma once

#include <vector>

#include "scenes/scene_description.h"

namespace penumbra {

/// The unnormalised filter value at `x` filter radii from the centre, |x| <= 1.
double filter_value(const Film& film, double x);

/// The table that sample_filter reads: FILTER_CELLS + 1 knots from the centre, 0, to the radius, 1, then the
/// weights of the cells between them. The weights average to 1 over all samples.
std::vector<float> filter_table(const Film& film);

}  // namespace penumbra
