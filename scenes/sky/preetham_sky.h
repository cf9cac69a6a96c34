// The clear sky of Preetham, Shirley and Smits 1999, A practical analytic model for daylight.
#pragma once

#include <glm/glm.hpp>

namespace penumbra {

/// Colours are linear Rec. 709 of spectral radiance in W/m²/sr/nm. A radiance of 1 at all wavelengths has
/// luminance 1.
class PreethamSky {
 public:
  /// `to_sun` is a unit vector with y up. The model requires the sun above the horizon; a lower sun is moved
  /// to the horizon. `turbidity` is in [1, 10]. The model was fitted to 2 to 6; values below 2 are raised to
  /// 2.
  PreethamSky(const glm::dvec3& to_sun, double turbidity);

  /// The radiance from direction w, a unit vector with y up. Directions at and below the horizon get the
  /// radiance of the horizon.
  [[nodiscard]] glm::dvec3 radiance(const glm::dvec3& w) const;

 private:
  /// Perez's distribution: a function of the cosine of the angle from the zenith and of the angle from the
  /// sun.
  struct Perez {
    double a, b, c, d, e;
    [[nodiscard]] double at(double cosine, double gamma) const;
  };
  Perez luminance_, x_, y_;
  /// At the zenith: luminance in cd/m² and chromaticity x, y, each divided by its Perez distribution there.
  glm::dvec3 zenith_;
  glm::dvec3 to_sun_;
};

/// The radiance of the sun's disk seen through the atmosphere, in the same units. `cosine` is that of the
/// angle from the zenith. Black below the horizon.
glm::dvec3 sun_radiance(double cosine, double turbidity);

constexpr double kSunRadius = 0.5358 / 2;  ///< degrees, as seen from the earth

}  // namespace penumbra
