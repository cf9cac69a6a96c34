// The colour bar of a heat map, with numbers.
#pragma once

#include <string>
#include <vector>

#include "scheduler/image/metrics/error_map.h"

namespace penumbra {

struct BarTick {
  double position = 0;  ///< from 0, the darkest colour, to 1
  std::string label;    ///< "0.05", "1e-05"
};

/// Round numbers in the range: powers of ten on a logarithmic scale of a decade or more, else multiples of 1,
/// 2 or 5 times a power of ten. About `most` of them; at least two, which are
/// the ends of the range where it holds fewer.
std::vector<BarTick> bar_ticks(const MapRange& range, int most);

/// The heat map with a bar of its colours below, and the numbers of `range` and the map's name below that, in
/// black on white. The pixels of the heat map are unchanged, at the top left; an image too narrow for the
/// numbers is extended to the right. The map's values in the bar are NaN.
Image with_color_bar(const Image& heat_map, const MapRange& range, const std::string& name);

}  // namespace penumbra
