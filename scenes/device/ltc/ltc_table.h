// The table of linearly transformed cosines for scenes that need it.
#pragma once

#include <vector>

#include "kernels/scene_types.h"

namespace penumbra {

/// LTC_SIZE^2 cells of GGX, then as many of Beckmann's distribution.
std::vector<LtcCell> ltc_table();

}  // namespace penumbra
