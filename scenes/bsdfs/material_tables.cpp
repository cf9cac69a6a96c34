#include "scenes/bsdfs/material_tables.h"

#include <algorithm>
#include <iterator>

#include "kernels/host/parallel.h"

namespace penumbra {
namespace {

constexpr float kReflectionAlbedo[] = {
#include "reflection_albedo.inc"  // by write_reflection_albedo.cpp
};
static_assert(std::size(kReflectionAlbedo) == 2 * REFLECTION_ROWS * CURVE_STRIDE);

}  // namespace

int MaterialTables::boundary(RoughBoundary boundary, int rows) {
  if (rows > 1) boundary.alpha = 0;
  const auto [at, added] = boundaries_.try_emplace({boundary, rows}, int(curves_.size()));
  if (!added) return at->second;
  for (int row = 0; row < rows; ++row) {
    if (rows > 1) boundary.alpha = row_alpha(row, rows);
    missing_.emplace_back(boundary, curves_.size());
    curves_.resize(curves_.size() + CURVE_KNOTS + 1);
  }
  return at->second;
}

int MaterialTables::reflection() {
  if (reflection_ < 0) {
    reflection_ = int(curves_.size());
    curves_.insert(curves_.end(), std::begin(kReflectionAlbedo), std::end(kReflectionAlbedo));
  }
  return reflection_;
}

void MaterialTables::compute() {
  in_parallel(missing_.size(), core_count(), [&](std::size_t i) {
    const auto& [boundary, at] = missing_[i];
    const auto through = boundary.transmittance();
    std::ranges::transform(through, &curves_[at], [](double value) { return float(value); });
    curves_[at + CURVE_KNOTS] = float(boundary.internal_reflectance());
  });
  missing_.clear();
}

}  // namespace penumbra
