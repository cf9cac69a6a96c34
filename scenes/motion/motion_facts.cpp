#include "scenes/motion/motion_facts.h"

#include <algorithm>
#include <cmath>

#include "scenes/settings.h"

namespace penumbra {
namespace {

/// Times in files are often in single precision: of a frame, that far from it.
constexpr double kFrameRounding = 1e-3;
constexpr double kMostFrames = 1e15;

/// For each node whether it or one of its parents has keys that vary.
std::vector<bool> moving_nodes(const SceneMotion& motion) {
  std::vector<bool> moves;
  for (const MovingNode& node : motion.nodes)
    moves.push_back((node.parent >= 0 && moves[std::size_t(node.parent)]) ||
                    (node.keys && node.keys->varies()));
  return moves;
}

}  // namespace

std::optional<MotionFacts> motion_facts(const SceneDescription& scene) {
  if (scene.motion == nullptr) return std::nullopt;
  const SceneMotion& motion = *scene.motion;
  const std::vector<bool> nodes = moving_nodes(motion);
  const auto moves = [&](const NodePlace& place) {
    return place.node >= 0 && nodes[std::size_t(place.node)];
  };
  const auto varies = [](const auto& keys) { return keys && keys->varies(); };
  MotionFacts facts{.clips = motion.clips, .time = scene.time, .times = time_range(motion)};
  facts.exposure = exposure_of(scene);
  facts.position = print_setting(scene, "camera.shutter_position");
  facts.curve = print_setting(scene, "camera.shutter_curve");
  for (const MovingShape& shape : motion.shapes) {
    const MeshDeformation* deformation = shape.deformation.get();
    const bool deforms =
        deformation != nullptr &&
        ((!deformation->targets.empty() && deformation->weights.varies()) ||
         std::ranges::any_of(deformation->skin.joints, [&](int joint) { return nodes[std::size_t(joint)]; }));
    facts.meshes_that_deform += deforms ? 1 : 0;
    facts.shapes.moving += deforms || moves(shape.place) ? 1 : 0;
  }
  facts.instances.moving = std::size_t(std::ranges::count_if(
      motion.instances, [&](const MovingInstance& instance) { return moves(instance.place); }));
  facts.emitters.moving =
      std::size_t(std::ranges::count_if(motion.emitters, [&](const MovingEmitter& emitter) {
        return moves(emitter.place) || varies(emitter.colour) || varies(emitter.strength);
      }));
  facts.shapes.all = scene.shapes.size();
  for (const ShapeGroup& group : scene.groups) facts.shapes.all += group.shapes.size();
  facts.instances.all = scene.instances.size();
  facts.emitters.all = scene.emitters.size();
  if (const auto& camera = motion.camera) {
    facts.camera = moves(camera->place);
    const std::pair<const char*, const std::optional<KeyedValue<double>>*> numbers[] = {
        {"fov", &camera->fov},
        {"focus_distance", &camera->focus_distance},
        {"aperture_radius", &camera->aperture_radius},
        {"scale_x", &camera->scale_x},
        {"scale_y", &camera->scale_y}};
    for (const auto& [name, keys] : numbers)
      if (varies(*keys)) facts.camera_numbers.emplace_back(name);
  }
  return facts;
}

std::optional<std::pair<std::int64_t, std::int64_t>> frames_between(std::pair<double, double> times,
                                                                    double fps) {
  const double first = std::ceil(times.first * fps - kFrameRounding),
               last = std::floor(times.second * fps + kFrameRounding);
  if (!(first <= last && first >= -kMostFrames && last <= kMostFrames)) return std::nullopt;
  return std::pair(std::int64_t(first), std::int64_t(last));
}

}  // namespace penumbra
