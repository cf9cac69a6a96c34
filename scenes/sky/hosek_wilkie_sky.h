// The clear sky of Hosek and Wilkie 2012, An analytic model for full spectral sky-dome radiance.
#pragma once

#include <array>
#include <glm/glm.hpp>

namespace penumbra {

/// The rows of the authors' tables, of turbidities 1 to 10, between which a turbidity lies.
struct BetweenTurbidities {
  static constexpr int kCount = 10;
  explicit BetweenTurbidities(double turbidity);
  int lower;  ///< the next row is the upper one
  double share_of_upper;
};

/// Colours are linear Rec. 709 of spectral radiance in W/m²/sr/nm. A radiance of 1 at all wavelengths has
/// luminance 1. The authors' coefficients for RGB are in hosek_wilkie/. Blender's Hosek-Wilkie sky has the
/// authors' coefficients for XYZ, times 2 pi / 683: 0.983 of this, 93 % of all numbers within 5 % of that,
/// and red up to a fifth more at the zenith above a low sun.
class HosekWilkieSky {
 public:
  /// `to_sun` is a unit vector with y up; a sun below the horizon is moved to it. `turbidity` is in [1, 10].
  /// `albedo` is that of the ground, in [0, 1].
  HosekWilkieSky(const glm::dvec3& to_sun, double turbidity, const glm::dvec3& albedo);

  /// The radiance from direction w, a unit vector with y up. Directions below the horizon get the radiance of
  /// the horizon. In hazy air about a low sun the model may be below 0.
  [[nodiscard]] glm::dvec3 radiance(const glm::dvec3& w) const;

 private:
  glm::dvec3 to_sun_;
  /// The paper's A to G, I and H.
  std::array<glm::dvec3, 9> parameters_;
  glm::dvec3 mean_;
};

}  // namespace penumbra
