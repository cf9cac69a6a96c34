// The hemispherical transmittance and reflectance of a rough boundary between two dielectrics. They define
// the rough plastic model, and are precomputed in double precision for the curves of BSDFs.
#pragma once

#include <array>
#include <cmath>
#include <compare>

#include "kernels/bsdf/families.h"

namespace penumbra {

struct SmoothRefraction {
  double reflected = 1;  ///< Fresnel reflectance
  double cosine = 0;     ///< of the transmitted direction; 0 for total reflection
};
/// Fresnel's equations and Snell's law at a cosine in [0, 1], for an index `ior` of the other side relative
/// to this one.
inline SmoothRefraction smooth_refraction(double cosine, double ior) {
  const double beyond = 1 - (1 - cosine * cosine) / (ior * ior);
  if (beyond <= 0) return {};
  const double t = std::sqrt(beyond);
  const double s = (cosine - ior * t) / (cosine + ior * t), p = (ior * cosine - t) / (ior * cosine + t);
  return {0.5 * (s * s + p * p), t};
}

struct RoughBoundary {
  int distribution = DISTRIBUTION_BECKMANN;  ///< DISTRIBUTION_*
  double alpha = 0.1;                        ///< roughness of the microfacets, above 0
  double ior = 1.5;                          ///< relative refractive index, below over above
  /// Light passes the boundary as if it were smooth, and nothing is reflected beneath it.
  bool smooth_base = false;
  /// Along its normal, of the coating beneath it, which absorbs exp(-optical_depth / cosine) of each way.
  double optical_depth = 0;

  friend auto operator<=>(const RoughBoundary&, const RoughBoundary&) = default;

  /// The transmitted fraction of light that arrives from above, at the cosines i / (CURVE_KNOTS - 1), of
  /// which the first is replaced by 1e-6: beneath the coating. Only single scattering is counted: light that
  /// meets a second microfacet is lost, as in all models with Smith's shadowing.
  [[nodiscard]] std::array<double, CURVE_KNOTS> transmittance() const;

  /// The fraction of diffuse light from below the coating that gets back there. With a smooth base it is the
  /// value for which the sum over all interreflections cancels the factor 1 / ior^2 of radiance that leaves
  /// the denser medium.
  [[nodiscard]] double internal_reflectance() const;
};

/// The fraction of diffuse light from below that a smooth boundary reflects back: the fit of Egan and
/// Hilgeman (1973), or that of d'Eon and Irving (2011) if the index below is the smaller one. The error is
/// within 0.6% for indices up to 2.
inline double smooth_internal_reflectance(double ior) {
  const double beneath = 1 / ior;  // from the side that the light is on
  if (beneath < 1) return 0.6681 + beneath * (0.7099 - 1.4399 * beneath) + 0.0636 / beneath;
  return 0.919317 + ior * (-3.4793 + ior * (6.75335 + ior * (-7.80989 + ior * (4.98554 + ior * -1.36881))));
}

/// The same for diffuse light from below a coating of that optical depth along its normal, which gets back
/// there. Without a coating it is the fit.
double smooth_internal_reflectance(double ior, double optical_depth);

/// The largest ratio of the refractive indices of a plastic's boundary. Beyond it the fit approaches 1 and
/// the model breaks down.
constexpr float kMostIndexRatio = 3.5f;

}  // namespace penumbra
