// Renders skies and suns to images for environment maps.
#pragma once

#include <glm/glm.hpp>

#include "scenes/image/bitmap.h"

namespace penumbra {

/// The contents of the image; y is up.
struct SkyImage {
  int width = 512;  ///< texels over a full turn; the height is half the width plus one
  double turbidity = 3;
  glm::dvec3 albedo{0.15};           ///< of the ground, per channel
  glm::dvec3 to_sun{0.0, 1.0, 0.0};  ///< unit
  double sky_scale = 1, sun_scale = 1;
  /// Factor of angles from the zenith: with 1 the sky ends at the horizon, with 2 at the nadir.
  double stretch = 1;
  double sun_radius = 0;  ///< of the disk that is drawn with the sun's power, in degrees; 0: no disk
};

/// Renders the image with the texels of kernels/light/envmap_grid.h. The sun's irradiance is that of its
/// disk, whatever the size of texels.
Bitmap draw_sky(const SkyImage& sky);

}  // namespace penumbra
