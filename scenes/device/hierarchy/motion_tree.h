// The hierarchy of what moves while the shutter is open, see kernels/motion/motion_bvh.h.
#pragma once

#include "scenes/device/scene_records.h"

namespace penumbra {

/// Builds it over the triangles, quadrics and instances with states; without any, there are no nodes. What
/// leaves its straight path by more than half of its size has several parts of the time. `extent`: of the
/// whole scene, see hierarchy_extent.
void add_motion_tree(SceneRecords& records, double extent);

}  // namespace penumbra
