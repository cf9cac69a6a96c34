// The coarser levels of a table of cumulative sums; see kernels/light/sum_search.h.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "kernels/light/sum_search.h"

namespace penumbra {

/// Appends the coarser levels of the non-decreasing sums from `first` to the end of the table.
inline void append_sum_levels(std::size_t first, std::vector<float>& table) {
  const SearchLevels levels = search_levels(int(table.size() - first));
  const auto fill = [&](int level) {
    table.resize(first + std::size_t(levels.start[level] + search_padded(levels.count[level])),
                 std::numeric_limits<float>::infinity());
  };
  fill(0);
  for (int level = 1; level < levels.levels; ++level) {
    for (int k = 0; k < levels.count[level]; ++k)
      table.push_back(table[first + std::size_t(levels.start[level - 1] + SEARCH_BRANCHES * k)]);
    fill(level);
  }
}

}  // namespace penumbra
