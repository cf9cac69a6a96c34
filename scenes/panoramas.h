// Panoramic projections: the numbers that kernels need, and the checks of their settings.
#pragma once

#include <glm/glm.hpp>

#include "scenes/cameras.h"

namespace penumbra {

[[nodiscard]] bool is_panorama(Projection projection);
[[nodiscard]] bool is_fisheye(Projection projection);

/// Where the film lies in the projection's coordinates, to the left and upwards; see PANORAMA_* of
/// kernels/scene_types.h.
struct PanoramaFilm {
  int kind = PANORAMA_NONE;
  glm::dvec2 center{0.0};  ///< of the film's centre
  glm::dvec2 half{1.0};    ///< from there to the left and to the top edge
  double limit = 0.0;      ///< radius of a fisheye's circle
};
PanoramaFilm panorama_film(const CameraSettings& camera, const Film& film);

/// How many pixels an angle of one radian is long on the film, at most; of equirectangular images at the
/// horizon, of an equidistant fisheye towards the edge of its circle.
double pixels_per_radian(const CameraSettings& camera, const Film& film);

/// check_camera's part for panoramas. Errors: ranges of angles that are empty or more than the sphere;
/// distortion, lateral chromatic aberration, an axis off the centre of anything but a fisheye; a stereo pair
/// on a film of odd height.
Expected<void> check_panorama(const CameraSettings& camera, const Film& film);

}  // namespace penumbra
