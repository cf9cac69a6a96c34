// Edges of lights that the camera sees, found once while the scene is built: see
// kernels/camera/light_edges.h.
#pragma once

#include "kernels/host/error.h"
#include "scenes/device/intersector.h"
#include "scenes/device/scene_records.h"

namespace penumbra {

/// Finds those of triangles, disks and spheres that emit the same from all their points, and let no rays
/// pass, where rays from the camera meet them. Fills their tables and the header's fields, with the feature
/// bit if there are any. The scene is whole otherwise; one of more than a million triangles that has no
/// hierarchy of the portable intersector gets none. Errors: as of add_hierarchy.
Expected<void> add_light_edges(SceneHeader& header, SceneRecords& records, BorrowedHierarchy& hierarchy);

}  // namespace penumbra
