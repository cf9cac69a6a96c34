// What moves in a scene. The scene shows everything at one time; set_time takes it to another.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scenes/motion/keyed_transform.h"
#include "scenes/motion/mesh_deformation.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// Follows a node: what is placed by `to_node` moves with it.
struct NodePlace {
  int node = -1;  ///< index into SceneMotion::nodes, or -1: the world
  glm::dmat4 to_node{1.0};
};

/// A shape that moves or deforms.
struct MovingShape {
  int group = -1;         ///< its group, or -1: it is one of the scene's own shapes
  std::size_t shape = 0;  ///< its index there
  Geometry rest = {};     ///< in its own space; triangles without area are still there
  NodePlace place = {};
  std::shared_ptr<const MeshDeformation> deformation = {};  ///< of a mesh, before `place`; null: none
  /// For a mesh without normals: it is faceted. Otherwise smooth normals are computed for each time.
  bool is_faceted = true;
};

struct MovingInstance {
  std::size_t instance = 0;  ///< index into SceneDescription::instances
  NodePlace place = {};
};

/// An emitter that is not a shape. Its strength is its intensity, irradiance or radiance, or the factor of
/// an image.
struct MovingEmitter {
  std::size_t emitter = 0;  ///< index into SceneDescription::emitters
  Emitter rest = {};        ///< as its place has it
  NodePlace place = {};
  std::optional<KeyedValue<glm::dvec3>> colour = {};  ///< of strength 1; absent: white
  std::optional<KeyedValue<double>> strength = {};    ///< if both are absent, the rest's is kept; else 1
};

struct MovingCamera {
  NodePlace place = {};
  std::optional<KeyedValue<double>> fov = {}, focus_distance = {}, aperture_radius = {}, scale_x = {},
                                    scale_y = {};  ///< see CameraSettings
};

/// A named animation of a file.
struct Clip {
  std::string name;
  double first = 0.0, last = 0.0;  ///< seconds of the first and the last key
  bool is_shown = false;           ///< whether its keys are here
};

struct SceneMotion {
  std::vector<Clip> clips = {};  ///< all of the file
  double default_time = 0.0;     ///< at which the scene is shown unless a time is asked for
  double shutter = 0.0;  ///< seconds for which the file's shutter is open, from the time that is shown on
  std::vector<MovingNode> nodes = {};
  std::vector<MovingShape> shapes = {};
  std::vector<MovingInstance> instances = {};
  std::vector<MovingEmitter> emitters = {};
  std::optional<MovingCamera> camera = {};
};

/// The transforms of all nodes to the world.
std::vector<glm::dmat4> nodes_to_world(const SceneMotion& motion, double time);

/// The times of the first and the last key of everything that moves. Nothing if nothing does.
std::optional<std::pair<double, double>> time_range(const SceneMotion& motion);

/// What becomes of a thing at a time at which it has no size.
enum class Vanished {
  kIsLeftOut,  ///< see set_time
  /// It keeps its kind and all of its points, in one place, for steps of its motion that begin or end there.
  /// A light keeps its strength.
  kIsAPoint
};

/// Takes everything that moves to a time. What a scene shows depends on the time alone, not on earlier ones.
/// What is flattened at that time is left out: a shape becomes a mesh without triangles, an instance hidden,
/// a light black. Only a mesh that becomes flat, and still has an area, is shown as that. A camera that is
/// sheared keeps its view direction, see camera_frame. Does nothing if the scene has no motion. Errors: a
/// sphere, disk or cylinder that would no longer be one; a mesh that reaches too far; a camera that is
/// flattened; an intensity below 0.
Expected<void> set_time(SceneDescription& scene, double time, Vanished vanished = Vanished::kIsLeftOut);

/// Which of the scene's own shapes move.
std::vector<bool> moving_shapes(const SceneDescription& scene);
/// Which of its instances move, or place a group with a shape that deforms.
std::vector<bool> moving_instances(const SceneDescription& scene);

}  // namespace penumbra
