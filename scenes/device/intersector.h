// The search structure of the intersector that a scene is rendered with.
#pragma once

#include <cstddef>

#include "kernels/host/error.h"
#include "kernels/scene_types.h"
#include "scenes/device/scene_records.h"

namespace penumbra {

enum class IntersectorChoice { kAuto, kPortable, kEmbree };

/// INTERSECTOR_* that is fastest for so many triangles, ours where both are equal: its images are the same
/// everywhere.
int intersector_for(std::size_t triangles);

/// Fills in the header's intersector and what it needs, over triangles, quadrics and instances that are
/// complete: the distinct vertices of a scene that is tested whole, or a hierarchy. Errors: those of building
/// the hierarchy.
Expected<void> add_intersector(IntersectorChoice choice, SceneHeader& header, SceneRecords& records);

/// The portable intersector's hierarchy over the records' primitives and instances, of which there are some,
/// and the roots of their groups. Errors: as of build_hierarchy.
Expected<void> add_hierarchy(SceneRecords& records);

/// The portable intersector's hierarchy while a scene is built, for what takes a look at it: built for the
/// first that needs it, and gone with this, unless the scene's own rays take it.
class BorrowedHierarchy {
 public:
  explicit BorrowedHierarchy(SceneRecords& records) : records_(records) {}
  BorrowedHierarchy(const BorrowedHierarchy&) = delete;
  BorrowedHierarchy& operator=(const BorrowedHierarchy&) = delete;
  ~BorrowedHierarchy();

  /// Of a scene with some primitive. Errors: as of add_hierarchy.
  Expected<void> need();

 private:
  SceneRecords& records_;
  bool borrowed_ = false;
};

}  // namespace penumbra
