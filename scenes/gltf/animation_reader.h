// Animations of glTF: keys of nodes, cameras and lights.
#pragma once

#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "scenes/gltf/asset.h"
#include "scenes/motion/scene_motion.h"
#include "scenes/reader_report.h"

namespace penumbra::gltf {

/// Whether there are keys that change a value.
template <typename Value>
bool varies(const std::optional<KeyedValue<Value>>& keys) {
  return keys && keys->varies();
}

struct NodeKeys {
  std::optional<KeyedValue<glm::dvec3>> translation = {}, scale = {};
  std::optional<KeyedValue<glm::dquat>> rotation = {};
  std::optional<KeyedValue<Weights>> weights = {};  ///< as many as the mesh has targets
  std::optional<KeyedValue<double>> visible = {};   ///< of KHR_node_visibility: 0 or 1, stepwise
};
struct CameraKeys {
  std::optional<KeyedValue<double>> yfov = {};             ///< radians, within (0, pi)
  std::optional<KeyedValue<double>> xmag = {}, ymag = {};  ///< not 0
};
/// At least 0 each.
struct LightKeys {
  std::optional<KeyedValue<glm::dvec3>> colour = {};
  std::optional<KeyedValue<double>> intensity = {};
};

/// The keys of everything that the shown clips target, by its index in the file.
struct Animation {
  std::vector<Clip> clips = {};  ///< all of the file; unnamed ones have their number as name
  int clip = -1;                 ///< the first whose keys are here; -1: the file has none
  std::map<std::size_t, NodeKeys> nodes = {};
  std::map<std::size_t, CameraKeys> cameras = {};
  std::map<std::size_t, LightKeys> lights = {};
};

/// Reads the clip of this name or, where no name fits, of this number; if `clip` is empty, the first
/// and those that change nothing that one before them changes. Reports with their place: no such clip;
/// channels that glTF 2.0 (3.11) or KHR_animation_pointer forbid; keys that are missing, not finite, before 0
/// s or do not ascend, or values that their target cannot have. Targets that this renderer cannot change are
/// warned of.
Animation read_animation(const Asset& asset, std::string_view clip, ReaderReport& report);

/// Gives the file's nodes, cameras and lights the values that they have at a time, in seconds.
void show(const Animation& animation, double time, tinygltf::Model& model);

}  // namespace penumbra::gltf
