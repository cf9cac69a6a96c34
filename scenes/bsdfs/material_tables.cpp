#include "scenes/bsdfs/material_tables.h"

#include <algorithm>
#include <iterator>

#include "kernels/host/parallel.h"
#include "scenes/bsdfs/measured_table.h"

namespace penumbra {
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

int MaterialTables::facets(const FacetCurves& curves) {
  const auto [at, added] = facets_.try_emplace(curves, int(curves_.size()));
  if (!added) return at->second;
  missing_facets_.emplace_back(curves, curves_.size());
  curves_.resize(curves_.size() + curves.size());
  return at->second;
}

int MaterialTables::measured(const std::shared_ptr<const MeasuredBrdf>& brdf) {
  const auto [at, added] = measured_.try_emplace(brdf, int(curves_.size()));
  if (added) std::ranges::copy(measured_table(*brdf), std::back_inserter(curves_));
  return at->second;
}

void MaterialTables::compute() {
  in_parallel(missing_.size(), core_count(), [&](std::size_t i) {
    const auto& [boundary, at] = missing_[i];
    const auto through = boundary.transmittance();
    std::ranges::transform(through, &curves_[at], [](double value) { return float(value); });
    curves_[at + CURVE_KNOTS] = float(boundary.internal_reflectance());
  });
  missing_.clear();
  in_parallel(missing_facets_.size(), core_count(), [&](std::size_t i) {
    const auto& [facets, at] = missing_facets_[i];
    std::ranges::copy(facets.curves(), &curves_[at]);
  });
  missing_facets_.clear();
}

}  // namespace penumbra
