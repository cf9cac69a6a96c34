// The cost of a device scene, compared with one that leaves out no feature: the numbers of `penumbra info`
// and of the report.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kernels/bsdf/families.h"
#include "kernels/features.h"
#include "kernels/host/device_scene.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The name, for users, of a bit of a scene's features, BSDF families or kinds of lights.
struct NamedBit {
  std::uint64_t bit;
  const char *name, *description;
};
#define LIST_FEATURE(name, description) {FEATURE_##name, #name, description},
inline constexpr NamedBit kFeatures[] = {PENUMBRA_FEATURES(LIST_FEATURE)};
#undef LIST_FEATURE
#define LIST_FAMILY(name, NAME, number, properties, description) \
  {std::uint64_t{1} << (number), "BSDF_" #NAME, description},
inline constexpr NamedBit kFamilies[] = {BSDF_FAMILIES(LIST_FAMILY)};
#undef LIST_FAMILY

/// The value for the scene as it is, and for a scene with every feature. The latter is missing if it would
/// take too long to find out.
struct Cost {
  std::uint64_t own = 0;
  std::optional<std::uint64_t> everything;
};

struct FeatureUse {
  std::string name;  ///< the bit's name, in capitals
  std::string description;
  bool used = false;
};

struct TableCost {
  std::string name;
  Cost bytes;
};

/// The native kernels. They are the same for every scene.
struct NativeCode {
  std::string isa;          ///< instruction set
  std::uint64_t bytes = 0;  ///< code and constants
};

/// Measured compile times of the scene's own kernels and of kernels with every feature, without any cache.
struct CompileTimes {
  std::string device;
  double own_seconds = 0, everything_seconds = 0;
};

struct SceneInventory {
  std::uint64_t features = 0;  ///< FEATURE_* bits
  std::vector<FeatureUse> feature_uses;
  std::vector<TableCost> tables;     ///< of the device scene
  Cost device_scene;                 ///< in bytes: header, tables and alignment
  Cost path_state;                   ///< in bytes: one path under way and its sample
  Cost result;                       ///< in bytes for each pixel of a work unit's result
  std::optional<NativeCode> native;  ///< if the caller provides it
  std::optional<CompileTimes> opencl;
};

/// The part of a scene that take_inventory needs: its settings, the data about its files, and those meshes
/// that are lights of uniform colour.
SceneDescription polygon_lights_of(const SceneDescription& description);

/// Counts the costs of a device scene. "Every feature" means shading normals for each triangle, outlines of
/// all mesh lights, both acceleration structures, and all planes. Their cost is found by building them. For
/// more than 65536 primitives that is done only if `thorough`.
SceneInventory take_inventory(const SceneDescription& description, const DeviceScene& scene, bool thorough);

}  // namespace penumbra
