// What materials share: tables of the scene that they point into.
#pragma once

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "kernels/bsdf/microfacet.h"

#include "scenes/bsdfs/rough_boundary.h"

namespace penumbra {

class MaterialTables {
 public:
  /// Of the scene's table of curves, to which it adds.
  explicit MaterialTables(std::vector<float>& curves) : curves_(curves) {}

  /// Where the curves of the boundary begin in the table of curves; of `rows` roughnesses, if there is more
  /// than one, instead of its own. Equal boundaries are computed and stored once.
  int boundary(RoughBoundary boundary, int rows);

  /// The roughness that curve_rows() finds in a row.
  static double row_alpha(int row, int rows) {
    const double first = std::pow(double(LEAST_ALPHA), 0.25);
    return std::pow(first + (1 - first) * row / (rows - 1), 4);
  }

 private:
  std::vector<float>& curves_;
  std::map<std::pair<RoughBoundary, int>, int> boundaries_;
};

}  // namespace penumbra
