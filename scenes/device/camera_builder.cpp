#include "scenes/device/camera_builder.h"

#include <cmath>
#include <numbers>

#include "scenes/device/to_vec3.h"

namespace penumbra {

Camera build_camera(const PerspectiveCamera& camera, const Film& film, const vec3& origin) {
  const double w = film.width, h = film.height;
  const double tangent = std::tan(0.5 * camera.fov * std::numbers::pi / 180);
  const bool along_x = camera.fov_axis == FovAxis::kX || (camera.fov_axis == FovAxis::kSmaller && w <= h) ||
                       (camera.fov_axis == FovAxis::kLarger && w > h);
  const double tan_x = camera.fov_axis == FovAxis::kDiagonal ? tangent * w / std::hypot(w, h)
                       : along_x                             ? tangent
                                                             : tangent * w / h;
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
