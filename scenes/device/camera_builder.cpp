#include "scenes/device/camera_builder.h"

#include <cmath>

#include "scenes/device/to_vec3.h"
#include "scenes/panoramas.h"

namespace penumbra {

Camera build_camera(const CameraSettings& camera, const Film& film, const vec3& origin) {
  const HalfFilm size = half_film(camera, film);
  const glm::dmat3 axes(camera.to_world);
  Camera result{};
  result.origin = origin;
  result.x = to_vec3(glm::normalize(axes[0]) * size.x);
  result.y = to_vec3(glm::normalize(axes[1]) * size.y);
  result.z = to_vec3(glm::normalize(axes[2]));
  camera_parameters([&](const char*, [[maybe_unused]] auto member, const auto&, const char*, auto... copied) {
    ((result.*copied = float(camera.*member)), ...);
  });
  result.parallel = camera.projection == Projection::kOrthographic ? 1.0f : 0.0f;
  result.offset_x = float(2 * camera.principal_point_offset_x);
  result.offset_y = float(2 * camera.principal_point_offset_y);
  const double turns = camera.blade_rotation / 360;
  result.blade_turn = float(turns - std::floor(turns));
  if (camera.is_distorted()) result.reach = float(distortion_reach(camera, film));
  result.image_scale = to_vec3(1.0 + camera.magnify());
  result.focus = to_vec3(camera.focus_distance * (1.0 + camera.refocus()));
  const auto differ = [](const glm::dvec3& v) { return v.x != v.y || v.y != v.z; };
  result.split =
      differ(camera.magnify()) || (camera.aperture_radius > 0 && differ(camera.refocus())) ? 1.0f : 0.0f;
  if (!is_panorama(camera.projection)) return result;
  const PanoramaFilm seen = panorama_film(camera, film);
  result.panorama = float(seen.kind);
  result.center_x = float(seen.center.x);
  result.center_y = float(seen.center.y);
  result.half_x = float(seen.half.x);
  result.half_y = float(seen.half.y);
  result.limit = float(seen.limit);
  const bool is_pair = camera.stereo != StereoPair::kNone;
  result.pictures = is_pair ? 2.0f : 1.0f;
  result.eye = is_pair ? float(0.5 * camera.interocular_distance) : 0.0f;
  return result;
}

std::uint64_t camera_features(const CameraSettings& camera) {
  const bool plain = camera.projection == Projection::kPerspective && camera.aperture_radius == 0.0 &&
                     !camera.is_distorted() && camera.principal_point_offset_x == 0.0 &&
                     camera.principal_point_offset_y == 0.0 && camera.magnify() == glm::dvec3(0.0);
  if (is_panorama(camera.projection)) return FEATURE_CAMERA | FEATURE_PANORAMA;
  return plain ? 0u : FEATURE_CAMERA;
}

}  // namespace penumbra
