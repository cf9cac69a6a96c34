// The size of a measured BRDF's table, see kernels/bsdf/measured.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kernels/bsdf/families.h"

namespace penumbra {

/// How many numbers a table has by its header, whose numbers may be any; -1: the header is implausible, or
/// incomplete.
inline std::int64_t measured_table_size(std::span<const float> table) {
  if (table.size() < MEASURED_HEADER) return -1;
  std::int64_t counts[10];
  for (std::size_t i = 0; i < 10; ++i) {
    const float least = i < 2 ? 1 : 2, most = i < 2 ? MEASURED_NODES : MEASURED_SIDE;
    if (!(table[i] >= least && table[i] <= most)) return -1;
    counts[i] = std::int64_t(table[i]);
  }
  const auto [phis, thetas, ndf_x, ndf_y, sigma_x, sigma_y, vndf_x, vndf_y, colour_x, colour_y] = counts;
  const std::int64_t vndf = (2 * vndf_x + 1) * vndf_y, luminance = (2 * colour_x + 1) * colour_y;
  return MEASURED_HEADER + phis + thetas + ndf_x * ndf_y + sigma_x * sigma_y +
         phis * thetas * (vndf + luminance + 3 * colour_x * colour_y);
}

}  // namespace penumbra
