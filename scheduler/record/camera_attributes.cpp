#include "scheduler/record/camera_attributes.h"

#include <glm/glm.hpp>

#include "scenes/panoramas.h"

namespace penumbra {
namespace {

/// Converts column vectors' matrices to OpenEXR's row vectors: our columns become rows.
RowMatrix rows_of(const glm::dmat4& matrix) {
  RowMatrix rows;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) rows[std::size_t(4 * i + k)] = float(matrix[i][k]) + 0.0f;  // avoids -0
  return rows;
}

/// OpenEXR's camera looks along +z like ours, but its x axis points to the right.
glm::dmat4 to_camera(const glm::dmat4& to_world) {
  const glm::dmat3 axes(-glm::normalize(glm::dvec3(to_world[0])), glm::normalize(glm::dvec3(to_world[1])),
                        glm::normalize(glm::dvec3(to_world[2])));
  const glm::dmat3 turned = glm::transpose(axes);
  glm::dmat4 result(turned);
  result[3] = glm::dvec4(-(turned * glm::dvec3(to_world[3])), 1.0);
  return result;
}

/// From camera space to the film: the inverse of camera_ray and film_point.
glm::dmat4 to_film(const CameraSettings& camera, const Film& film) {
  const HalfFilm half = half_film(camera, film);
  const double larger = 1.0 + camera.magnify().y;
  const double x = larger / (2.0 * half.x), y = -larger / (2.0 * half.y);
  const double center_x = 0.5 - camera.principal_point_offset_x,
               center_y = 0.5 - camera.principal_point_offset_y;
  const double near = camera.near_clip, length = camera.far_clip - near;
  if (camera.projection == Projection::kOrthographic)
    return {{x, 0, 0, 0}, {0, y, 0, 0}, {0, 0, 1 / length, 0}, {center_x, center_y, -near / length, 1}};
  const double depth = camera.far_clip / length;
  return {{x, 0, 0, 0}, {0, y, 0, 0}, {center_x, center_y, depth, 1}, {0, 0, -near * depth, 0}};
}

}  // namespace

ImageCamera camera_attributes(const CameraSettings& camera, const Film& film) {
  const glm::dmat4 world_to_camera = to_camera(camera.to_world);
  if (is_panorama(camera.projection)) return {rows_of(world_to_camera), std::nullopt};
  return {rows_of(world_to_camera), rows_of(to_film(camera, film) * world_to_camera)};
}

}  // namespace penumbra
