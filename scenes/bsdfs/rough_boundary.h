// What a rough boundary between two dielectrics lets through, altogether: precomputed in double for the
// curves of BSDFs, as the model of rough plastic is defined by it.
#pragma once

#include <array>
#include <compare>

#include "kernels/bsdf/families.h"

namespace penumbra {

struct RoughBoundary {
  int distribution = DISTRIBUTION_BECKMANN;  ///< DISTRIBUTION_*
  double alpha = 0.1;                        ///< roughness of its microfacets, above 0
  double ior = 1.5;                          ///< refractive index beneath it over that above it
  /// What goes through it does so as through a smooth one, and beneath it nothing is reflected.
  bool smooth_base = false;

  friend auto operator<=>(const RoughBoundary&, const RoughBoundary&) = default;

  /// The share of light that goes through, arriving from above at the cosines i / (CURVE_KNOTS - 1), the
  /// first of which is 1e-6. Once scattered: what meets a second microfacet is lost, as to all of Smith's
  /// models.
  [[nodiscard]] std::array<double, CURVE_KNOTS> transmittance() const;

  /// The share of diffuse light from beneath that it reflects. Of a smooth base it is that whose sum over all
  /// times cancels the 1 / ior^2 by which radiance falls on its way out.
  [[nodiscard]] double internal_reflectance() const;
};

/// The same of a smooth boundary, of diffuse light from beneath: the fit of Egan and Hilgeman (1973), or of
/// d'Eon and Irving (2011) where the index beneath is the smaller one. Within 0.6% for indices up to 2.
inline double smooth_internal_reflectance(double ior) {
  const double beneath = 1 / ior;  // from the side that the light is on
  if (beneath < 1) return 0.6681 + beneath * (0.7099 - 1.4399 * beneath) + 0.0636 / beneath;
  return 0.919317 + ior * (-3.4793 + ior * (6.75335 + ior * (-7.80989 + ior * (4.98554 + ior * -1.36881))));
}

/// Of the indices on the two sides of a plastic's boundary: beyond, the fit nears 1, and the model breaks
/// down.
constexpr float kMostIndexRatio = 3.5f;

}  // namespace penumbra
