// What a scene costs as it is, beside what it would cost if nothing were left out: in numbers, for `penumbra
// info` and the report.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The scene's own figure, and that with every feature; nothing where finding it out would take too long.
struct Cost {
  std::uint64_t own = 0;
  std::optional<std::uint64_t> everything;
};

struct FeatureUse {
  std::string name;  ///< of the bit, in capitals
  std::string description;
  bool used = false;
};

struct TableCost {
  std::string name;
  Cost bytes;
};

/// The native kernels, which are the same for every scene.
struct NativeCode {
  std::string isa;          ///< instruction set
  std::uint64_t bytes = 0;  ///< code and constants
};

/// Measured: the scene's own kernels against those with everything, without any cache.
struct CompileTimes {
  std::string device;
  double own_seconds = 0, everything_seconds = 0;
};

struct SceneInventory {
  std::uint64_t features = 0;  ///< FEATURE_* bits
  std::vector<FeatureUse> feature_uses;
  std::vector<TableCost> tables;     ///< of the device scene
  Cost device_scene;                 ///< bytes: header, tables and what aligns them
  Cost path_state;                   ///< bytes of one path under way and its sample
  Cost result;                       ///< bytes for each pixel of a work unit's result
  std::optional<NativeCode> native;  ///< where the caller knows
  std::optional<CompileTimes> opencl;
};

/// The settings of a scene, what is known of its files, and of its shapes the meshes that are lights of one
/// colour: all that take_inventory wants of it.
SceneDescription polygon_lights_of(const SceneDescription& description);

/// With everything means: shading normals for each triangle, outlines of all mesh lights, both search
/// structures, all planes. What that takes is found by building it, which for more than 65536 primitives is
/// done only if `thorough`.
SceneInventory take_inventory(const SceneDescription& description, const DeviceScene& scene, bool thorough);

}  // namespace penumbra
