#include "scenes/motion/scene_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/instances.h"
#include "scenes/mesh_tools.h"
#include "scenes/traceable.h"
#include "scenes/transform.h"

namespace penumbra {
namespace {

class Pose {
 public:
  Pose(SceneDescription& scene, double time, Vanished vanished)
      : scene_(scene),
        motion_(*scene.motion),
        time_(time),
        vanished_(vanished),
        nodes_(nodes_to_world(motion_, time)) {}

  Expected<void> apply() {
    for (const MovingShape& moving : motion_.shapes)
      if (auto done = pose(moving); !done) return done;
    for (const MovingInstance& moving : motion_.instances) {
      ShapeInstance& instance = scene_.instances.at(moving.instance);
      instance.to_world = to_world(moving.place);
      instance.hidden = is_singular(instance.to_world);
    }
    for (const MovingEmitter& moving : motion_.emitters)
      if (auto done = pose(moving); !done) return done;
    return motion_.camera ? pose(*motion_.camera) : Expected<void>();
  }

 private:
  [[nodiscard]] glm::dmat4 to_world(const NodePlace& place) const {
    return place.node < 0 ? place.to_node : nodes_.at(std::size_t(place.node)) * place.to_node;
  }

  [[nodiscard]] std::unexpected<Error> fail_at(const std::string& name, const std::string& what) const {
    return fail(fmt::format("'{}' at time {} s: {}", name, time_, what));
  }

  Expected<void> pose(const MovingShape& moving) {
    Shape& shape = moving.group < 0 ? scene_.shapes.at(moving.shape)
                                    : scene_.groups.at(std::size_t(moving.group)).shapes.at(moving.shape);
    const glm::dmat4 placed = to_world(moving.place);
    if (const auto* rest = std::get_if<Mesh>(&moving.rest)) {
      auto mesh = posed(*rest, moving, placed);
      if (!mesh) return fail_at(shape.name, mesh.error().message);
      shape.geometry = std::move(*mesh);
      return {};
    }
    shape.geometry = moving.rest;
    if (is_singular(placed)) {
      if (vanished_ == Vanished::kIsLeftOut)
        shape.geometry = Mesh{};
      else
        shrink(shape.geometry, placed);
      return {};
    }
    auto moved = placed_shape(shape, placed);
    if (!moved) return fail_at(shape.name, moved.error().message);
    shape.geometry = std::move(moved->geometry);
    return {};
  }

  [[nodiscard]] Expected<Mesh> posed(const Mesh& rest, const MovingShape& moving,
                                     const glm::dmat4& placed) const {
    Mesh mesh = rest;
    if (moving.deformation != nullptr) deform(*moving.deformation, time_, nodes_, mesh);
    const auto vanishes = [&](const glm::uvec3& t) {
      const glm::dvec3 a = transform_point(placed, mesh.positions[t.x]);
      return glm::length(glm::cross(transform_point(placed, mesh.positions[t.y]) - a,
                                    transform_point(placed, mesh.positions[t.z]) - a)) <= kSmallestCross;
    };
    if (std::ranges::all_of(mesh.triangles, vanishes)) {
      if (vanished_ == Vanished::kIsLeftOut) return Mesh{};
      for (glm::dvec3& position : mesh.positions) position = transform_point(placed, position);
      mesh.normals.clear();
      return mesh;
    }
    glm::dmat4 to_world = placed;
    if (is_singular(placed)) {
      // The normals of a flattened mesh are those of its plane.
      for (glm::dvec3& position : mesh.positions) position = transform_point(placed, position);
      mesh.normals.clear();
      to_world = glm::dmat4(1.0);
    }
    // A mirroring transform reverses the winding; normals, where there are any, determine it.
    if (mesh.normals.empty() && is_mirror(to_world))
      for (std::size_t i = 0; i < mesh.triangles.size(); ++i) turn_over(mesh, i);
    if (auto done = place_mesh(mesh, to_world, mesh.normals.empty() && moving.is_faceted); !done)
      return std::unexpected(done.error());
    return mesh.triangles.empty() && vanished_ == Vanished::kIsLeftOut ? Mesh{} : mesh;
  }

  Expected<void> pose(const MovingEmitter& moving) {
    Emitter& emitter = scene_.emitters.at(moving.emitter);
    emitter = moving.rest;
    const glm::dmat4 placed = to_world(moving.place);
    if (!is_singular(placed)) {
      place(emitter, placed);
    } else if (vanished_ == Vanished::kIsLeftOut) {
      set_strength(emitter, glm::vec3(0.0f));
      return {};
    } else {
      shrink(emitter, placed);
    }
    if (!moving.colour && !moving.strength) return {};
    const glm::dvec3 strength = (moving.colour ? value_at(*moving.colour, time_) : glm::dvec3(1.0)) *
                                (moving.strength ? value_at(*moving.strength, time_) : 1.0);
    for (int c = 0; c < 3; ++c)
      if (!(strength[c] >= 0.0 && strength[c] < 1e37))
        return fail(fmt::format("a light at time {} s: its strength must be at least 0 and finite, not {}",
                                time_, strength[c]));
    set_strength(emitter, glm::vec3(strength));
    return {};
  }

  /// To a point where the transform, which is singular, takes the centre. Directions have no meaning there.
  static void shrink(Geometry& geometry, const glm::dmat4& placed) {
    if (auto* sphere = std::get_if<Sphere>(&geometry)) {
      sphere->center = transform_point(placed, sphere->center);
      sphere->radius = 0.0;
    }
    if (auto* disk = std::get_if<Disk>(&geometry)) {
      disk->center = transform_point(placed, disk->center);
      disk->radius = 0.0;
    }
    if (auto* cylinder = std::get_if<Cylinder>(&geometry)) {
      cylinder->center = transform_point(placed, cylinder->center);
      cylinder->radius = cylinder->length = 0.0;
    }
  }
  static void shrink(Emitter& emitter, const glm::dmat4& placed) {
    if (auto* point = std::get_if<PointLight>(&emitter))
      point->position = transform_point(placed, point->position);
    if (auto* spot = std::get_if<SpotLight>(&emitter)) spot->to_world[3] = placed * spot->to_world[3];
    if (auto* projector = std::get_if<ProjectorLight>(&emitter))
      projector->to_world[3] = placed * projector->to_world[3];
  }

  static void place(Emitter& emitter, const glm::dmat4& placed) {
    if (auto* point = std::get_if<PointLight>(&emitter))
      point->position = transform_point(placed, point->position);
    if (auto* sun = std::get_if<DirectionalLight>(&emitter))
      sun->direction = transform_vector(placed, sun->direction);
    if (auto* spot = std::get_if<SpotLight>(&emitter)) spot->to_world = placed * spot->to_world;
    if (auto* map = std::get_if<EnvironmentMapLight>(&emitter)) map->to_world = placed * map->to_world;
    if (auto* projector = std::get_if<ProjectorLight>(&emitter))
      projector->to_world = placed * projector->to_world;
  }

  static void set_strength(Emitter& emitter, const glm::vec3& strength) {
    if (auto* point = std::get_if<PointLight>(&emitter)) point->intensity = strength;
    if (auto* sky = std::get_if<ConstantEnvironment>(&emitter)) sky->radiance = strength;
    if (auto* sun = std::get_if<DirectionalLight>(&emitter)) sun->irradiance = strength;
    if (auto* spot = std::get_if<SpotLight>(&emitter)) spot->intensity = strength;
    if (auto* map = std::get_if<EnvironmentMapLight>(&emitter)) map->scale = strength.x;
    if (auto* projector = std::get_if<ProjectorLight>(&emitter)) projector->scale = strength.x;
  }

  Expected<void> pose(const MovingCamera& moving) {
    CameraSettings& camera = scene_.camera;
    const glm::dmat4 placed = to_world(moving.place);
    const auto frame = camera_frame(placed);
    if (!frame) return fail_at("camera", frame.error().message);
    camera.to_world = *frame;
    const auto set = [&](const std::optional<KeyedValue<double>>& keys, double& value) {
      if (keys) value = value_at(*keys, time_);
    };
    set(moving.fov, camera.fov);
    set(moving.focus_distance, camera.focus_distance);
    set(moving.aperture_radius, camera.aperture_radius);
    set(moving.scale_x, camera.scale_x);
    set(moving.scale_y, camera.scale_y);
    return {};
  }

  SceneDescription& scene_;
  const SceneMotion& motion_;
  double time_;
  Vanished vanished_;
  std::vector<glm::dmat4> nodes_;
};

/// The least interval that holds all times added.
struct TimeRange {
  std::optional<std::pair<double, double>> range = {};

  template <typename Value>
  void add(const KeyedValue<Value>& keys) {
    if (!keys.varies()) return;
    const double first = keys.times.front(), last = keys.times.back();
    range = range ? std::pair(std::min(range->first, first), std::max(range->second, last))
                  : std::pair(first, last);
  }
  template <typename Value>
  void add(const std::optional<KeyedValue<Value>>& keys) {
    if (keys) add(*keys);
  }
};

}  // namespace

std::vector<glm::dmat4> nodes_to_world(const SceneMotion& motion, double time) {
  std::vector<glm::dmat4> result;
  result.reserve(motion.nodes.size());
  for (const MovingNode& node : motion.nodes) {
    const glm::dmat4 local = node.keys ? transform_at(*node.keys, time) : node.to_parent;
    result.push_back(node.parent < 0 ? local : result.at(std::size_t(node.parent)) * local);
  }
  return result;
}

std::optional<std::pair<double, double>> time_range(const SceneMotion& motion) {
  TimeRange all;
  for (const MovingNode& node : motion.nodes)
    if (node.keys) {
      all.add(node.keys->translation);
      all.add(node.keys->rotation);
      all.add(node.keys->stretch);
    }
  for (const MovingShape& shape : motion.shapes)
    if (shape.deformation != nullptr) all.add(shape.deformation->weights);
  for (const MovingEmitter& emitter : motion.emitters) {
    all.add(emitter.colour);
    all.add(emitter.strength);
  }
  if (const auto& camera = motion.camera)
    for (const auto* keys : {&camera->fov, &camera->focus_distance, &camera->aperture_radius,
                             &camera->scale_x, &camera->scale_y})
      all.add(*keys);
  return all.range;
}

Expected<void> set_time(SceneDescription& scene, double time, Vanished vanished) {
  if (scene.motion == nullptr) return {};
  scene.time = time;
  return Pose(scene, time, vanished).apply();
}

std::vector<bool> moving_shapes(const SceneDescription& scene) {
  std::vector<bool> moves(scene.shapes.size(), false);
  if (scene.motion != nullptr)
    for (const MovingShape& moving : scene.motion->shapes)
      if (moving.group < 0) moves.at(moving.shape) = true;
  return moves;
}

std::vector<bool> moving_instances(const SceneDescription& scene) {
  std::vector<bool> moves(scene.instances.size(), false);
  if (scene.motion == nullptr) return moves;
  std::vector<bool> deforms(scene.groups.size(), false);
  for (const MovingShape& moving : scene.motion->shapes)
    if (moving.group >= 0) deforms.at(std::size_t(moving.group)) = true;
  // A group may hold instances of groups before it.
  for (std::size_t g = 0; g < scene.groups.size(); ++g)
    for (const ShapeInstance& inside : scene.groups[g].instances)
      if (deforms[std::size_t(inside.group)]) deforms[g] = true;
  for (std::size_t i = 0; i < moves.size(); ++i) moves[i] = deforms[std::size_t(scene.instances[i].group)];
  for (const MovingInstance& moving : scene.motion->instances) moves.at(moving.instance) = true;
  return moves;
}

}  // namespace penumbra
