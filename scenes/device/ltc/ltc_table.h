// The table of linearly transformed cosines for scenes that need it.
#pragma once

#include <vector>

#include "kernels/scene_types.h"

namespace penumbra {

/// LTC_SIZE^2 cells for the GGX distribution, then as many for Beckmann's.
std::vector<LtcCell> ltc_table();

}  // namespace penumbra
