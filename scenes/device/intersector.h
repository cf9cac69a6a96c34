// Builds the acceleration structure of the intersector that renders a scene.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <utility>

#include "kernels/host/device_scene.h"
#include "kernels/host/error.h"
#include "kernels/scene_types.h"
#include "scenes/device/hierarchy/hierarchy_cache.h"
#include "scenes/device/scene_records.h"

namespace penumbra {

enum class IntersectorChoice { kAuto, kPortable, kEmbree };

/// The intersector (INTERSECTOR_*) that is fastest for that number of triangles. If both are equally fast,
/// the portable one, because its images are the same on every machine.
int intersector_for(std::size_t triangles);

/// Builds the portable intersector's hierarchy, or finds it.
class HierarchySource {
 public:
  /// `earlier`: see DeviceSceneOptions.
  HierarchySource(std::filesystem::path folder, const DeviceScene* earlier)
      : cache_(std::move(folder)), earlier_(earlier) {}

  /// See HierarchyInput::still.
  void set_still(const StillRecords& still) { still_ = still; }

  /// Adds the hierarchy over the primitives and instances of the records that do not move while the shutter
  /// is open, and the roots of their groups. There must be a primitive. `groups_alone`: only the trees of
  /// groups. Errors: those of build_hierarchy.
  Expected<void> add_hierarchy(SceneRecords& records, bool groups_alone = false);

  /// What is still in the hierarchy that was added.
  [[nodiscard]] const StillRecords& built() const { return built_; }

 private:
  HierarchyCache cache_;
  const DeviceScene* earlier_;
  std::optional<StillRecords> still_;
  StillRecords built_;
};

/// Sets the header's intersector and builds what it needs: a hierarchy, or the distinct vertices of a scene
/// small enough to test every primitive. Triangles, quadrics and instances must be complete. Errors: those of
/// building the hierarchy.
Expected<void> add_intersector(IntersectorChoice choice, HierarchySource& source, SceneHeader& header,
                               SceneRecords& records);

/// The portable intersector's hierarchy for steps of the scene's construction that trace rays. It is built on
/// the first call of need(), and removed in the destructor unless rendering uses it.
class TemporaryHierarchy {
 public:
  TemporaryHierarchy(HierarchySource& source, SceneRecords& records) : source_(source), records_(records) {}
  TemporaryHierarchy(const TemporaryHierarchy&) = delete;
  TemporaryHierarchy& operator=(const TemporaryHierarchy&) = delete;
  ~TemporaryHierarchy();

  /// Builds the hierarchy if it is missing. The scene must have a primitive. Errors: those of
  /// build_hierarchy.
  Expected<void> need();

 private:
  HierarchySource& source_;
  SceneRecords& records_;
  bool borrowed_ = false;
};

}  // namespace penumbra
