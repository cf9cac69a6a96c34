// Tables of the scene that materials share and point into.
#pragma once

#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "kernels/bsdf/microfacet.h"

#include "scenes/bsdfs/facet_albedo.h"
#include "scenes/bsdfs/rough_boundary.h"
#include "scenes/measured_file.h"

namespace penumbra {

class MaterialTables {
 public:
  /// `curves` is the scene's table of curves; new curves are appended to it.
  explicit MaterialTables(std::vector<float>& curves) : curves_(curves) {}

  /// The index in the table at which the curves of the boundary begin. With `rows` > 1 there are curves for
  /// that many values of roughness, instead of one for the boundary's own. Equal boundaries are stored once.
  int boundary(RoughBoundary boundary, int rows);

  /// The index at which the curves of an OpenPBR surface begin. Equal ones are stored once.
  int facets(const FacetCurves& curves);

  /// The index at which the table of a measured BRDF begins. Equal pointers are stored once.
  int measured(const std::shared_ptr<const MeasuredBrdf>& brdf);

  /// Computes the curves, on all cores. Call it after the last boundary.
  void compute();

  /// The roughness of row number `row`, the inverse of curve_rows().
  static double row_alpha(int row, int rows) {
    const double first = std::pow(double(LEAST_ALPHA), 0.25);
    return std::pow(first + (1 - first) * row / (rows - 1), 4);
  }

 private:
  std::vector<float>& curves_;
  std::map<std::pair<RoughBoundary, int>, int> boundaries_;
  std::map<FacetCurves, int> facets_;
  std::map<std::shared_ptr<const MeasuredBrdf>, int> measured_;
  std::vector<std::pair<RoughBoundary, std::size_t>> missing_;  ///< curves that are not computed, and where
  std::vector<std::pair<FacetCurves, std::size_t>> missing_facets_;  ///< likewise
};

}  // namespace penumbra
