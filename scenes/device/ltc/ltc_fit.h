// The fit of one cell of the table of linearly transformed cosines (LTC), and the microfacet lobe to which it
// is fitted. All in double precision and independent of the kernels. See README.md beside this file.
#pragma once

#include <glm/glm.hpp>

namespace penumbra::ltc {

enum class Distribution { kGgx, kBeckmann };

/// The reflection of an isotropic microfacet surface without its Fresnel term, for a fixed view direction.
/// The normal is (0, 0, 1) and the viewer is at (-sin, 0, cos), so the lobe leans to positive x. Smith's
/// masking and shadowing are multiplied (Walter et al. 2007).
class Lobe {
 public:
  /// `alpha` > 0 is the roughness; `cosine`, in (0, 1], is that of the view direction.
  Lobe(Distribution distribution, double alpha, double cosine);
  /// The BRDF times the cosine of wi, a unit vector; 0 below the horizon.
  [[nodiscard]] double operator()(const glm::dvec3& wi) const;
  /// Samples a direction from (u, v) in [0, 1)^2 by the visible normals of GGX (Heitz 2018), whatever the
  /// lobe's distribution. The direction may be below the horizon.
  [[nodiscard]] glm::dvec3 sample(double u, double v) const;
  /// The density of sample() per solid angle.
  [[nodiscard]] double pdf(const glm::dvec3& wi) const;
  [[nodiscard]] const glm::dvec3& wo() const { return wo_; }
  [[nodiscard]] double alpha() const { return alpha_; }

 private:
  Distribution distribution_;
  double alpha_;
  glm::dvec3 wo_;
  double masking_, ggx_masking_;  ///< masking in the view direction
};

/// A cell of the table: see LTC_CELL_FIELDS in kernels/scene_types.h.
struct Cell {
  double lean = 0, width_x = 1, width_y = 1, albedo = 1, schlick = 0;
};

/// The transformed cosine lobe of a cell. The rows of the inverse matrix are (1, 0, -shift) / width_x, (0, 1,
/// 0) / width_y and (0, 0, 1).
struct Transform {
  double width_x, width_y, shift;
  /// The density per solid angle; 0 below the horizon.
  [[nodiscard]] double operator()(const glm::dvec3& wi) const;
  [[nodiscard]] glm::dvec3 sample(double u, double v) const;
};
Transform transform_of(const Cell& cell, double alpha, double cosine);

/// The error of a cell: the distance of its density times its albedo from the lobe.
struct Residual {
  /// 1/2 integral of (f - g)^2 / (f + g), divided by the integral of the lobe; from 0 to 1
  double discrimination = 0;
  double square = 0;  ///< sqrt(integral of (f - g)^2 / integral of f^2)
};
/// Estimated from `side`^2 points sampled from the lobe and as many from the cell.
Residual residual(const Lobe& lobe, const Cell& cell, int side);

/// The cell with the least discrimination, found by optimisation from `start`. Its albedo and Fresnel term
/// are computed by quadrature.
Cell fit(const Lobe& lobe, const Cell& start);

/// The knots of the table: the roughness of a row and the viewer's cosine of a column.
double knot_alpha(double row, int size);
double knot_cosine(double column, int size);

}  // namespace penumbra::ltc
