// The albedo of a half-space that scatters, and the single-scattering albedo that gives it one.
#pragma once

#include <array>
#include <vector>

#include "kernels/scene_types.h"

namespace penumbra {

/// A half-space of a homogeneous medium with the phase function of Henyey and Greenstein and no boundary that
/// reflects. It is lit evenly from all directions, and its albedo is the share of the light that comes out
/// again. Independent of the extinction.
///
/// The albedos are computed by adding and doubling layers (van de Hulst 1980, "Multiple light scattering") in
/// double precision, with kStreams cosines for each hemisphere. Delta-M scaling (Wiscombe 1977) takes the
/// narrowest part of the phase function for light that did not scatter. Between them a polynomial in the root
/// of the similarity parameter interpolates. Errors are below 1e-4 for |g| up to 0.8.
class HalfSpace {
 public:
  /// `g`: the mean cosine of scattering, in (-1, 1).
  explicit HalfSpace(double g);

  /// The albedo for a single-scattering albedo in [0, 1].
  [[nodiscard]] double albedo(double single) const;

  /// Its inverse: the single-scattering albedo for an albedo; both are in [0, 1].
  [[nodiscard]] double single_albedo(double albedo) const;

  /// The roots of the complements of single-scattering albedos to 1, for CURVE_KNOTS equidistant albedos from
  /// 0 to 1: the curve of albedo_of_colour (kernels/integrator/interiors.h), with CURVE_STRIDE numbers.
  [[nodiscard]] std::vector<float> curve() const;

 private:
  static constexpr int kNodes = 17;
  /// By the root s of the similarity parameter (1 - single) / (1 - g single).
  [[nodiscard]] double albedo_by_root(double s) const;

  double g_;
  std::array<double, kNodes> albedos_{};  ///< at Chebyshev points of s in [0, 1]
};

/// That of a mean cosine. It takes milliseconds, so each thread makes it once.
const HalfSpace& half_space(float g);

}  // namespace penumbra
