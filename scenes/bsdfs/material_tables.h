// What materials share: tables of the scene that they point into.
#pragma once

#include <map>
#include <vector>

#include "scenes/bsdfs/rough_boundary.h"

namespace penumbra {

class MaterialTables {
 public:
  /// Of the scene's table of curves, to which it adds.
  explicit MaterialTables(std::vector<float>& curves) : curves_(curves) {}

  struct StoredBoundary {
    int curve;       ///< where its transmittance begins in the table of curves
    float internal;  ///< its internal reflectance
  };
  /// Equal boundaries are computed and stored once.
  const StoredBoundary& boundary(const RoughBoundary& boundary) {
    const auto [at, added] = boundaries_.try_emplace(boundary);
    if (added) {
      at->second = {int(curves_.size()), float(boundary.internal_reflectance())};
      for (const double value : boundary.transmittance()) curves_.push_back(float(value));
    }
    return at->second;
  }

 private:
  std::vector<float>& curves_;
  std::map<RoughBoundary, StoredBoundary> boundaries_;
};

}  // namespace penumbra
