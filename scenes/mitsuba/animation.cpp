#include "scenes/mitsuba/animation.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string_view>
#include <utility>

#include "scenes/mitsuba/shape_parameters.h"
#include "scenes/transform.h"

namespace penumbra::mitsuba {
namespace {

double number_of(const Object* sensor, std::string_view name) {
  if (sensor == nullptr) return 0.0;
  for (const Parameter& parameter : sensor->parameters) {
    if (parameter.name != name) continue;
    if (const auto* number = std::get_if<double>(&parameter.value)) return *number;
    if (const auto* whole = std::get_if<std::int64_t>(&parameter.value)) return double(*whole);
  }
  return 0.0;
}

bool can_move(const Object& object) {
  return object.tag == "sensor" || object.tag == "shape" || object.tag == "emitter";
}

bool is_mesh_file(const Object& object) {
  return object.tag == "shape" && (object.type == ObjShape::kPlugin || object.type == PlyShape::kPlugin ||
                                   object.type == SerializedShape::kPlugin);
}

}  // namespace

Shutter shutter_of(const Object* sensor) {
  const double open = number_of(sensor, "shutter_open");
  return {open, std::max(open, number_of(sensor, "shutter_close"))};
}

Shutter shutter_of(const Context& context) {
  for (const Child& child : context.tree.scene.children)
    if (child.object != nullptr && child.object->tag == "sensor") return shutter_of(child.object);
  return {};
}

Animations::Animations(const Context& context, const Object* sensor) {
  const Shutter shutter = shutter_of(sensor);
  motion_.default_time = shutter.open;
  motion_.shutter = shutter.close - shutter.open;
  for (Object& object : context.tree.objects) {
    for (Parameter& parameter : object.parameters) {
      if (auto* texts = std::get_if<TextAnimationValue>(&parameter.value)) {
        std::vector<TextKey> keys = std::move(texts->keys);
        parameter.tag = "string";
        parameter.value = parameter.text = keys.front().text;
        parameter.value_location = keys.front().location;
        if (keys.size() < 2) continue;
        if (is_mesh_file(object) && parameter.name == "filename")
          files_.emplace(&object, std::move(keys));
        else
          context.diagnostics.warn(
              parameter.location,
              fmt::format("the filename of a mesh changes over time; the {} of {} '{}' stays '{}'",
                          parameter.name, object.tag, object.type, parameter.text));
        continue;
      }
      auto* animation = std::get_if<AnimationValue>(&parameter.value);
      if (animation == nullptr) continue;
      std::vector<TransformKey> keys = std::move(animation->keys);
      parameter.value = keys.front().transform;
      if (object.tag == "shape" && parameter.name == "animation") parameter.name = "to_world";
      auto parts = keyed_transform(keys);
      if (!parts) {
        context.diagnostics.error(parameter.location, parts.error().message);
        continue;
      }
      if (!parts->varies()) continue;
      const glm::dmat4 shown = transform_at(*parts, time());
      parameter.value = shown;
      if (can_move(object) && parameter.name == "to_world")
        animations_.emplace(&object, Animation{std::move(keys), std::move(*parts), shown});
      else
        context.diagnostics.warn(
            parameter.location,
            fmt::format(
                "sensors, shapes and emitters move; the {} of a {} is as at {} s, when the shutter opens",
                parameter.name, object.tag, time()));
    }
  }
}

Animations::Animation* Animations::find(const Object& object) {
  const auto found = animations_.find(&object);
  return found != animations_.end() ? &found->second : nullptr;
}

int Animations::node_of(Animation& animation) {
  if (animation.node < 0) {
    animation.node = int(motion_.nodes.size());
    motion_.nodes.push_back({.keys = animation.parts});
  }
  return animation.node;
}

std::span<const TransformKey> Animations::keys_of(const Object& object) const {
  const auto found = animations_.find(&object);
  return found != animations_.end() ? std::span<const TransformKey>(found->second.keys)
                                    : std::span<const TransformKey>();
}

std::span<const TextKey> Animations::files_of(const Object& mesh) const {
  const auto found = files_.find(&mesh);
  return found != files_.end() ? std::span<const TextKey>(found->second) : std::span<const TextKey>();
}

void Animations::add_camera(const Object& sensor, const SceneDescription& scene) {
  Animation* animation = find(sensor);
  if (animation == nullptr) return;
  MovingCamera camera{{node_of(*animation), glm::dmat4(1.0)}};
  if (scene.camera.projection == Projection::kOrthographic) {
    // The axes are at right angles, so that their lengths change as linearly as the stretch does.
    KeyedValue<double> x, y;
    for (const auto& [time, transform] : animation->keys) {
      x.times.push_back(time);
      y.times.push_back(time);
      x.values.push_back(glm::length(glm::dvec3(transform[0])));
      y.values.push_back(glm::length(glm::dvec3(transform[1])));
    }
    camera.scale_x = std::move(x);
    camera.scale_y = std::move(y);
  }
  motion_.camera = std::move(camera);
}

void Animations::add_emitters(const Object& emitter, std::size_t first, const SceneDescription& scene) {
  Animation* animation = find(emitter);
  if (animation == nullptr) return;
  for (std::size_t i = first; i < scene.emitters.size(); ++i)
    if (!std::holds_alternative<ConstantEnvironment>(scene.emitters[i]))
      motion_.emitters.push_back({.emitter = i, .place = place_of(*animation)});
}

void Animations::add_shape(const Object& shape, int group, std::size_t index, bool computed_normals,
                           const DeformingMesh* deforming) {
  Animation* animation = find(shape);
  if (deforming != nullptr && deforming->changes())
    motion_.shapes.push_back({.group = group,
                              .shape = index,
                              .rest = deforming->rest,
                              .place = animation != nullptr ? NodePlace{node_of(*animation), glm::dmat4(1.0)}
                                                            : NodePlace{-1, deforming->to_world},
                              .deformation = deforming->deformation,
                              .is_faceted = !computed_normals});
  else if (animation != nullptr)
    motion_.shapes.push_back(
        {.group = group, .shape = index, .place = place_of(*animation), .is_faceted = !computed_normals});
}

void Animations::add_instance(const Object& instance, std::size_t index) {
  if (Animation* animation = find(instance))
    motion_.instances.push_back({index, {node_of(*animation), glm::dmat4(1.0)}});
}

void Animations::install(SceneDescription& scene) {
  if (motion_.shapes.empty() && motion_.instances.empty() && motion_.emitters.empty() && !motion_.camera)
    return;
  for (MovingEmitter& moving : motion_.emitters) moving.rest = scene.emitters[moving.emitter];
  for (MovingShape& moving : motion_.shapes) {
    if (moving.deformation != nullptr) continue;  // it has its rest
    moving.rest =
        (moving.group < 0 ? scene.shapes : scene.groups[std::size_t(moving.group)].shapes)[moving.shape]
            .geometry;
    // They are computed again at each time, because a stretch changes them.
    if (auto* mesh = std::get_if<Mesh>(&moving.rest); mesh != nullptr && !moving.is_faceted)
      mesh->normals.clear();
  }
  scene.time = motion_.default_time;
  scene.motion = std::make_shared<const SceneMotion>(std::move(motion_));
}

}  // namespace penumbra::mitsuba
