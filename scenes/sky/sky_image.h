// Skies and suns as images for environment maps.
#pragma once

#include <glm/glm.hpp>

#include "scenes/image/bitmap.h"

namespace penumbra {

/// What is in the picture; y is up.
struct SkyImage {
  int width = 512;  ///< texels, over a whole turn; half as many and one high
  double turbidity = 3;
  glm::dvec3 albedo{0.15};           ///< of the ground, channel by channel
  glm::dvec3 to_sun{0.0, 1.0, 0.0};  ///< unit
  double sky_scale = 1, sun_scale = 1;
  double stretch = 1;     ///< of angles from the zenith: 1 ends the sky at the horizon, 2 at the nadir
  double sun_radius = 0;  ///< of the disk that is drawn with the sun's power, degrees; 0: none
};

/// Its texels are those of kernels/light/envmap_grid.h. The sun's irradiance is that of the disk, however
/// large texels are.
Bitmap draw_sky(const SkyImage& sky);

}  // namespace penumbra
