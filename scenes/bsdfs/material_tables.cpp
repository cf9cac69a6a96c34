#include "scenes/bsdfs/material_tables.h"

#include <future>

namespace penumbra {

int MaterialTables::boundary(RoughBoundary boundary, int rows) {
  if (rows > 1) boundary.alpha = 0;
  const auto [at, added] = boundaries_.try_emplace({boundary, rows}, int(curves_.size()));
  if (!added) return at->second;
  std::vector<std::future<std::vector<double>>> computed;
  for (int row = 0; row < rows; ++row) {
    if (rows > 1) boundary.alpha = row_alpha(row, rows);
    computed.push_back(std::async([boundary] {
      const auto through = boundary.transmittance();
      std::vector<double> values(through.begin(), through.end());
      values.push_back(boundary.internal_reflectance());
      return values;
    }));
  }
  for (auto& values : computed)
    for (const double value : values.get()) curves_.push_back(float(value));
  return at->second;
}

}  // namespace penumbra
