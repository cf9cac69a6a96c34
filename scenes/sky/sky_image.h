// Renders skies and suns to images for environment maps.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "scenes/image/bitmap.h"

namespace penumbra {

/// The contents of the image; y is up.
struct SkyImage {
  int width = 512;  ///< texels over a full turn; the height is half the width plus one
  double turbidity = 3;
  glm::dvec3 albedo{0.15};           ///< of the ground, per channel
  glm::dvec3 to_sun{0.0, 1.0, 0.0};  ///< unit
  double sky_scale = 1, sun_scale = 1;
  /// Factor of angles from the zenith, the sun's too: with 1 the sky ends at the horizon, with 2 at the
  /// nadir.
  double stretch = 1;
  /// Whether the horizon goes on below the end of the sky, darker and darker to black at the nadir.
  bool extend = false;
  double sun_radius = 0;  ///< of the disk that is drawn with the sun's power, in degrees; 0: no disk
  /// Whether the disk is the model's, darker at the limb; else it is Mitsuba 3's plain disk.
  bool complex_sun = false;
};

/// Renders the image with the texels of kernels/light/envmap_grid.h. Rows about the end of the sky have the
/// share of their texels that is above it. The sun's irradiance is that of its disk, whatever the size of
/// texels. A sun below the horizon leaves all black, as the models have no night. Channels are below 0 where
/// colours are outside the gamut; a texel whose channels' sum is below 0, at the horizon of hazy air, is
/// black.
Bitmap draw_sky(const SkyImage& sky);

/// The mean of skies whose suns are in the directions `of_sky`, and of suns in the directions `of_sun`;
/// `sky.to_sun` does not count.
Bitmap draw_mean_sky(SkyImage sky, std::span<const glm::dvec3> of_sky, std::span<const glm::dvec3> of_sun);

/// The direction at `factor` times the angle from the zenith, which is y.
glm::dvec3 stretched(const glm::dvec3& w, double factor);

}  // namespace penumbra
