#include "scenes/device/quadric_record.h"

#include <numbers>

#include "kernels/light/light_kinds.h"
#include "scenes/device/to_vec3.h"

namespace penumbra {

std::optional<Quadric> quadric_record(const Shape& shape,
                                      const std::function<vec3(const glm::dvec3& p, double reach)>& local) {
  Quadric q{};
  q.length = 1.0f;
  q.light = -1;
  q.orientation = shape.flip_normals ? -1.0f : 1.0f;
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    q.kind = QUADRIC_SPHERE;
    q.center = local(sphere->center, sphere->radius);
    q.radius = float(sphere->radius);
    q.x_axis = to_vec3(sphere->x_axis);
    q.y_axis = to_vec3(sphere->y_axis);
    q.normal = to_vec3(sphere->z_axis);
    return q;
  }
  if (const auto* disk = std::get_if<Disk>(&shape.geometry)) {
    q.kind = QUADRIC_DISK;
    q.center = local(disk->center, disk->radius);
    q.normal = to_vec3(shape.flip_normals ? -disk->normal : disk->normal);
    q.radius = float(disk->radius);
    q.orientation = 1.0f;
    q.x_axis = to_vec3(disk->x_axis);
    q.y_axis = to_vec3(disk->y_axis);
    return q;
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
    q.kind = QUADRIC_CYLINDER;
    q.center = local(cylinder->center, cylinder->radius + cylinder->length);
    q.normal = to_vec3(cylinder->axis);
    q.radius = float(cylinder->radius);
    q.length = float(cylinder->length);
    q.x_axis = to_vec3(cylinder->x_axis);
    q.y_axis = to_vec3(cylinder->y_axis);
    return q;
  }
  return std::nullopt;
}

Light light_of_quadric(const Quadric& quadric) {
  constexpr int kKinds[] = {LIGHT_SPHERE, LIGHT_DISK, LIGHT_CYLINDER};  // of each QUADRIC_*
  static_assert(QUADRIC_SPHERE == 0 && QUADRIC_DISK == 1 && QUADRIC_CYLINDER == 2);
  Light light{};
  light.kind = kKinds[quadric.kind];
  light.p0 = quadric.center;
  if (quadric.kind != QUADRIC_SPHERE) light.p1 = quadric.normal;
  light.p2 = make_vec3(quadric.radius, quadric.orientation,
                       quadric.kind == QUADRIC_CYLINDER ? quadric.length : 0.0f);
  return light;
}

double quadric_area(const Geometry& geometry) {
  if (const auto* sphere = std::get_if<Sphere>(&geometry))
    return 4 * std::numbers::pi * sphere->radius * sphere->radius;
  if (const auto* disk = std::get_if<Disk>(&geometry)) return std::numbers::pi * disk->radius * disk->radius;
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry))
    return 2 * std::numbers::pi * cylinder->radius * cylinder->length;
  return 0;
}

}  // namespace penumbra
