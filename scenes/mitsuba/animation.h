// Animated transforms of sensors, shapes, instances and emitters.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "scenes/mitsuba/deforming_mesh.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/motion/scene_motion.h"

namespace penumbra::mitsuba {

/// The times between which a sensor sees the scene, `open` at most `close`.
struct Shutter {
  double open = 0.0, close = 0.0;
};
/// That of a sensor; null: both are 0.
Shutter shutter_of(const Object* sensor);
/// That of the first sensor.
Shutter shutter_of(const Context& context);

/// The animations of a file. While the scene is built, each object is where it is when the shutter opens.
class Animations {
 public:
  /// Replaces every animation by its transform at that time, or its first text. The animation of an instance
  /// may be named `animation`. Transforms of other objects than sensors, shapes and emitters stay so, and
  /// texts other than the filename of a mesh, with a warning.
  Animations(const Context& context, const Object* sensor);

  /// The time at which the scene is built.
  [[nodiscard]] double time() const { return motion_.default_time; }
  /// The keys of an object that moves, at least two; else none.
  [[nodiscard]] std::span<const TransformKey> keys_of(const Object& object) const;
  /// The files of a mesh that deforms, at least two; else none.
  [[nodiscard]] std::span<const TextKey> files_of(const Object& mesh) const;

  // Each of these adds what was built for the object, if it moves.
  void add_camera(const Object& sensor, const SceneDescription& scene);
  void add_emitters(const Object& emitter, std::size_t first, const SceneDescription& scene);
  /// `computed_normals`: those of a mesh are not its file's. `deforming`: null if it does not.
  void add_shape(const Object& shape, int group, std::size_t index, bool computed_normals,
                 const DeformingMesh* deforming);
  void add_instance(const Object& instance, std::size_t index);

  /// Gives the finished scene its motion, if anything moves.
  void install(SceneDescription& scene);

 private:
  struct Animation {
    std::vector<TransformKey> keys;
    KeyedTransform parts;
    glm::dmat4 shown;  ///< when the shutter opens
    int node = -1;     ///< of the motion; -1: not yet
  };
  /// Null: it does not move.
  Animation* find(const Object& object);
  int node_of(Animation& animation);
  /// The place of what was built with the transform `shown`.
  NodePlace place_of(Animation& animation) { return {node_of(animation), glm::inverse(animation.shown)}; }

  std::map<const Object*, Animation> animations_;
  std::map<const Object*, std::vector<TextKey>> files_;
  SceneMotion motion_;
};

}  // namespace penumbra::mitsuba
