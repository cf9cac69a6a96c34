// Clear skies: Preetham, Shirley and Smits 1999, A practical analytic model for daylight.
#pragma once

#include <glm/glm.hpp>

namespace penumbra {

/// In linear Rec. 709, of spectral radiance in W/m²/sr/nm: a light of radiance 1 at all wavelengths has
/// luminance 1.
class PreethamSky {
 public:
  /// `to_sun` is unit, y up; the model is one of the sun above the horizon, where it is held otherwise.
  /// `turbidity` in [1, 10]; the model was made from 2 to 6, and below 2 it is held.
  PreethamSky(const glm::dvec3& to_sun, double turbidity);

  /// Of the unit direction, y up; at and below the horizon that of the horizon.
  [[nodiscard]] glm::dvec3 radiance(const glm::dvec3& w) const;

 private:
  /// Perez's distribution: of angles from the zenith, by its cosine, and from the sun.
  struct Perez {
    double a, b, c, d, e;
    [[nodiscard]] double at(double cosine, double gamma) const;
  };
  Perez luminance_, x_, y_;
  glm::dvec3 zenith_;  ///< luminance, cd/m², and chromaticity x, y, each over its distribution there
  glm::dvec3 to_sun_;
};

/// Radiance of the sun's disk, as seen through the atmosphere at the angle from the zenith whose cosine this
/// is, likewise. Black below the horizon.
glm::dvec3 sun_radiance(double cosine, double turbidity);

constexpr double kSunRadius = 0.5358 / 2;  ///< as seen from the earth, degrees

}  // namespace penumbra
