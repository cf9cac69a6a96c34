#include "scenes/scene_bounds.h"

#include <variant>
#include <vector>

#include "scenes/transform.h"

namespace penumbra {

SceneBounds bounds_of(std::span<const Shape> shapes) {
  SceneBounds bounds;
  for (const Shape& shape : shapes) {
    if (const auto* mesh = std::get_if<Mesh>(&shape.geometry))
      for (const glm::dvec3& p : mesh->positions) bounds.include(p);
    if (const auto* sphere = std::get_if<Sphere>(&shape.geometry))
      bounds.include(sphere->center, sphere->radius);
    if (const auto* disk = std::get_if<Disk>(&shape.geometry)) bounds.include(disk->center, disk->radius);
    if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
      bounds.include(cylinder->center, cylinder->radius);
      bounds.include(cylinder->center + cylinder->length * cylinder->axis, cylinder->radius);
    }
    // The control points of a spline are around it, and so are those of its radius.
    if (const auto* curves = std::get_if<Curves>(&shape.geometry))
      for (const Curve& curve : curves->curves)
        for (const ControlPoint& point : curve) bounds.include(point.position, std::max(point.radius, 0.0));
  }
  return bounds;
}

SceneBounds bounds_of(const SceneBounds& box, const glm::dmat4& to_world) {
  SceneBounds bounds;
  if (box.empty()) return bounds;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p((corner & 1) != 0 ? box.high.x : box.low.x, (corner & 2) != 0 ? box.high.y : box.low.y,
                       (corner & 4) != 0 ? box.high.z : box.low.z);
    bounds.include(transform_point(to_world, p));
  }
  return bounds;
}

SceneBounds bounds_of(const SceneDescription& scene, std::span<const PlacedGroup> placed) {
  SceneBounds bounds = bounds_of(scene.shapes);
  std::vector<SceneBounds> groups;
  for (const ShapeGroup& group : scene.groups) groups.push_back(bounds_of(group.shapes));
  for (const PlacedGroup& place : placed)
    bounds.include(bounds_of(groups[std::size_t(place.group)], place.to_world));
  if (bounds.empty()) bounds.include(glm::dvec3(scene.camera.to_world[3]));
  return bounds;
}

}  // namespace penumbra
