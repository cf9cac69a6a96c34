// The truth that the linearly transformed cosines are fitted to, and the fit of one cell of their table: in
// double, and independent of the kernels. See README.md beside this file.
#pragma once

#include <glm/glm.hpp>

namespace penumbra::ltc {

enum class Distribution { kGgx, kBeckmann };

/// An isotropic microfacet reflection without its Fresnel term, seen under a fixed angle: normal (0, 0, 1),
/// viewer at (-sin, 0, cos), so that the lobe leans to positive x. Smith's masking and shadowing as a product
/// of two (Walter et al. 2007).
class Lobe {
 public:
  /// `alpha` > 0; `cosine` in (0, 1].
  Lobe(Distribution distribution, double alpha, double cosine);
  /// f times the cosine of wi, a unit vector; 0 below the horizon.
  [[nodiscard]] double operator()(const glm::dvec3& wi) const;
  /// A direction for (u, v) in [0, 1)^2 by the visible normals of GGX (Heitz 2018), whatever the lobe's own
  /// distribution; maybe below the horizon.
  [[nodiscard]] glm::dvec3 sample(double u, double v) const;
  /// Its density per solid angle.
  [[nodiscard]] double pdf(const glm::dvec3& wi) const;
  [[nodiscard]] const glm::dvec3& wo() const { return wo_; }
  [[nodiscard]] double alpha() const { return alpha_; }

 private:
  Distribution distribution_;
  double alpha_;
  glm::dvec3 wo_;
  double masking_, ggx_masking_;  ///< of the viewer
};

/// A cell of the table: see LTC_CELL_FIELDS in kernels/scene_types.h.
struct Cell {
  double lean = 0, width_x = 1, width_y = 1, albedo = 1, schlick = 0;
};

/// The transformed cosine of a cell: the rows of the inverse matrix are (1, 0, -shift) / width_x,
/// (0, 1, 0) / width_y and (0, 0, 1).
struct Transform {
  double width_x, width_y, shift;
  /// Density per solid angle; 0 below the horizon.
  [[nodiscard]] double operator()(const glm::dvec3& wi) const;
  [[nodiscard]] glm::dvec3 sample(double u, double v) const;
};
Transform transform_of(const Cell& cell, double alpha, double cosine);

/// How far the density of a cell, times its albedo, is from the lobe.
struct Residual {
  double discrimination = 0;  ///< 1/2 integral of (f - g)^2 / (f + g) over the lobe's own integral: 0 to 1
  double square = 0;          ///< sqrt(integral of (f - g)^2 / integral of f^2)
};
/// By `side`^2 points of either.
Residual residual(const Lobe& lobe, const Cell& cell, int side);

/// The cell with the least discrimination, sought from `start` on; its albedo and Fresnel term by quadrature.
Cell fit(const Lobe& lobe, const Cell& start);

/// Knots of the table: roughness and cosine of the viewer of row and column.
double knot_alpha(double row, int size);
double knot_cosine(double column, int size);

}  // namespace penumbra::ltc
