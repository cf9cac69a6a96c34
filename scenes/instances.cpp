#include "scenes/instances.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/mesh_tools.h"
#include "scenes/transform.h"

namespace penumbra {
namespace {

/// Beyond these limits products of a transform's numbers exceed the range of single precision.
constexpr double kLeastScale = 1e-12, kMostScale = 1e12;

Expected<void> check_transform(const glm::dmat4& to_world, const std::string& name) {
  const auto wrong = [&](std::string_view what) {
    return fail(fmt::format("instance '{}': its transform {}", name, what));
  };
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 3; ++j)
      if (!std::isfinite(to_world[i][j])) return wrong("has numbers that are not finite");
  if (is_singular(to_world)) return wrong("flattens space");
  const glm::dmat3 there(to_world), back = glm::inverse(there);
  for (int i = 0; i < 3; ++i) {
    const double scales[] = {glm::length(there[i]), glm::length(back[i])};
    for (const double scale : scales)
      if (!(scale >= kLeastScale && scale <= kMostScale))
        return wrong("makes lengths too large or too small for single precision");
  }
  return {};
}

class Placement {
 public:
  explicit Placement(const SceneDescription& scene) : scene_(scene) {}

  Expected<std::vector<PlacedGroup>> run() {
    if (auto done = count(); !done) return std::unexpected(done.error());
    for (std::size_t i = 0; i < scene_.instances.size(); ++i)
      if (auto done = place(scene_.instances[i], glm::dmat4(1.0), i); !done)
        return std::unexpected(done.error());
    return std::move(placed_);
  }

 private:
  [[nodiscard]] const ShapeGroup& group_of(const ShapeInstance& instance) const {
    return scene_.groups.at(std::size_t(instance.group));
  }

  /// Counts before anything is placed, because nested groups multiply.
  [[nodiscard]] Expected<void> count() const {
    std::vector<std::size_t> places(scene_.groups.size());
    std::vector<int> levels(scene_.groups.size(), 1);
    const auto sum = [&](const std::vector<ShapeInstance>& instances) {
      std::size_t total = 0;
      for (const ShapeInstance& i : instances)
        total = std::min(total + places.at(std::size_t(i.group)), kMaxInstances + 1);
      return total;
    };
    for (std::size_t g = 0; g < places.size(); ++g) {
      const ShapeGroup& group = scene_.groups[g];
      for (const ShapeInstance& inside : group.instances) {
        if (std::size_t(inside.group) >= g)
          return fail(fmt::format("group '{}' holds one that does not come before it", group.name));
        levels[g] = std::max(levels[g], levels[std::size_t(inside.group)] + 1);
      }
      places[g] = sum(group.instances) + (group.shapes.empty() ? 0 : 1);
    }
    for (const ShapeInstance& instance : scene_.instances)
      if (levels[std::size_t(instance.group)] > kMaxGroupLevels)
        return fail(fmt::format("instance '{}' is of groups within groups of more than {} levels",
                                instance.name, kMaxGroupLevels));
    if (sum(scene_.instances) <= kMaxInstances) return {};
    return fail(
        fmt::format("the scene has more than {} instances, those within groups counted wherever their "
                    "groups are",
                    kMaxInstances));
  }

  // Recursion ends, because a group holds only groups with smaller indices and the depth is limited.
  Expected<void> place(const ShapeInstance& instance, const glm::dmat4& outside, std::size_t outermost) {
    if (instance.hidden) return {};
    const glm::dmat4 to_world = outside * instance.to_world;
    if (auto done = check_transform(to_world, scene_.instances[outermost].name); !done) return done;
    const ShapeGroup& group = group_of(instance);
    if (!group.shapes.empty()) placed_.push_back({instance.group, outermost, to_world});
    for (const ShapeInstance& inside : group.instances)
      if (auto done = place(inside, to_world, outermost); !done) return done;
    return {};
  }

  const SceneDescription& scene_;
  std::vector<PlacedGroup> placed_;
};

}  // namespace

Expected<std::vector<PlacedGroup>> place_groups(const SceneDescription& scene) {
  return Placement(scene).run();
}

std::optional<Cylinder> placed_cylinder(const Cylinder& cylinder, const glm::dmat4& to_world) {
  constexpr double kSameScale = 1e-4;  // as of uniform_scale
  const glm::dvec3 x = transform_vector(to_world, cylinder.x_axis),
                   y = transform_vector(to_world, cylinder.y_axis),
                   z = transform_vector(to_world, cylinder.axis);
  const double across = glm::length(x), along = glm::length(z);
  if (!(std::abs(glm::length(y) / across - 1) < kSameScale) ||
      !(std::abs(glm::dot(x, y)) < kSameScale * across * across) ||
      !(std::abs(glm::dot(x, z)) < kSameScale * across * along) ||
      !(std::abs(glm::dot(y, z)) < kSameScale * across * along))
    return std::nullopt;
  const glm::dvec3 axis = z / along, first = glm::normalize(x - glm::dot(x, axis) * axis);
  const double side = glm::dot(glm::cross(axis, first), y) < 0 ? -1.0 : 1.0;
  return Cylinder{transform_point(to_world, cylinder.center),
                  axis,
                  cylinder.radius * across,
                  cylinder.length * along,
                  first,
                  side * glm::cross(axis, first)};
}

Expected<Shape> placed_shape(const Shape& shape, const glm::dmat4& to_world) {
  Shape placed = shape;
  const auto wrong = [&](std::string_view what) {
    return fail(fmt::format("shape '{}' of a group: {}", shape.name, what));
  };
  const auto direction = [&](const glm::dvec3& d) { return glm::normalize(transform_vector(to_world, d)); };
  if (auto* mesh = std::get_if<Mesh>(&placed.geometry)) {
    for (glm::dvec3& p : mesh->positions) p = transform_point(to_world, p);
    const glm::dmat3 matrix = normal_matrix(to_world);
    for (glm::vec3& n : mesh->normals) n = glm::vec3(glm::normalize(matrix * glm::dvec3(n)));
    transform_tangents(*mesh, to_world);
    if (is_mirror(to_world))
      for (std::size_t i = 0; i < mesh->triangles.size(); ++i) turn_over(*mesh, i);
  }
  if (auto* sphere = std::get_if<Sphere>(&placed.geometry)) {
    const auto scale = uniform_scale(to_world);
    if (!scale) return wrong("an instance's transform makes an emitting sphere something else");
    sphere->center = transform_point(to_world, sphere->center);
    sphere->radius *= *scale;
    sphere->x_axis = direction(sphere->x_axis);
    sphere->y_axis = direction(sphere->y_axis);
    sphere->z_axis = direction(sphere->z_axis);
  }
  if (auto* disk = std::get_if<Disk>(&placed.geometry)) {
    const glm::dvec3 x = transform_vector(to_world, disk->x_axis),
                     y = transform_vector(to_world, disk->y_axis);
    const double scale = glm::length(x);
    constexpr double kSameScale = 1e-4;  // as of uniform_scale
    if (!(std::abs(glm::length(y) / scale - 1) < kSameScale) ||
        !(std::abs(glm::dot(x, y)) < kSameScale * scale * scale))
      return wrong("an instance's transform makes an emitting disk something else");
    disk->center = transform_point(to_world, disk->center);
    disk->normal = glm::normalize(normal_matrix(to_world) * disk->normal);
    disk->radius *= scale;
    disk->x_axis = x / scale;
    disk->y_axis = glm::normalize(y);
  }
  if (auto* cylinder = std::get_if<Cylinder>(&placed.geometry)) {
    const auto there = placed_cylinder(*cylinder, to_world);
    if (!there) return wrong("an instance's transform makes an emitting cylinder something else");
    *cylinder = *there;
  }
  return placed;
}

Expected<std::vector<Shape>> placed_emitters(const SceneDescription& scene,
                                             std::span<const PlacedGroup> placed,
                                             bool (*wanted)(const Shape&)) {
  std::vector<Shape> shapes;
  std::size_t triangles = 0;
  for (const PlacedGroup& place : placed)
    for (const Shape& shape : scene.groups[std::size_t(place.group)].shapes) {
      if (!wanted(shape)) continue;
      const auto* mesh = std::get_if<Mesh>(&shape.geometry);
      triangles += mesh != nullptr ? mesh->triangles.size() : 1;
      if (triangles > kMaxPlacedEmitters)
        return fail(fmt::format("instances of emitting shapes make more than {} triangles that emit",
                                kMaxPlacedEmitters));
      auto there = placed_shape(shape, place.to_world);
      if (!there) return std::unexpected(there.error());
      shapes.push_back(std::move(*there));
    }
  return shapes;
}

Expected<SceneDescription> without_instances(const SceneDescription& scene) {
  const auto placed = place_groups(scene);
  if (!placed) return std::unexpected(placed.error());
  SceneDescription flat = scene;
  flat.groups.clear();
  flat.instances.clear();
  for (const PlacedGroup& place : *placed)
    for (const Shape& shape : scene.groups[std::size_t(place.group)].shapes) {
      auto there = placed_shape(shape, place.to_world);
      if (!there) return std::unexpected(there.error());
      flat.shapes.push_back(std::move(*there));
    }
  return flat;
}

}  // namespace penumbra
