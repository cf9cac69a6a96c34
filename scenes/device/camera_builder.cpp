#include "scenes/device/camera_builder.h"

#include "scenes/device/to_vec3.h"
#include "scenes/view_angle.h"

namespace penumbra {

Camera build_camera(const PerspectiveCamera& camera, const Film& film, const vec3& origin) {
  const double w = film.width, h = film.height;
  const double tan_x = half_width_tangent(camera.fov, camera.fov_axis, w, h);
  const glm::dmat3 axes(camera.to_world);
  Camera result{};
  result.origin = origin;
  result.x = to_vec3(glm::normalize(axes[0]) * tan_x);
  result.y = to_vec3(glm::normalize(axes[1]) * (tan_x * h / w));
  result.z = to_vec3(glm::normalize(axes[2]));
  camera_parameters([&](const char*, [[maybe_unused]] auto member, const auto&, const char*, auto... copied) {
    ((result.*copied = float(camera.*member)), ...);
  });
  return result;
}

}  // namespace penumbra
