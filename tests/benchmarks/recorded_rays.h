// The rays that a render traces, recorded block by block, so that all intersectors are timed on the same
// rays.
#pragma once

#include <vector>

#include "kernels/host/block_memory.h"
#include "kernels/host/device_scene.h"
#include "kernels/host/native_kernels.h"
#include "worker/device.h"

namespace penumbra {

enum class RayKind { kCamera, kBounce, kShadow };

/// One call of an intersect or occlude stage: the block's paths as the stage saw them.
struct RecordedStage {
  RayKind kind = RayKind::kCamera;
  int count = 0;
  BlockMemory memory;  ///< of `count` rounded up to whole lanes

  [[nodiscard]] PathState paths() { return memory.block().paths; }
};

struct RecordedRays {
  std::vector<RecordedStage> stages;
  std::size_t rays = 0;  ///< with a positive length: those that an intersector has to trace
};

/// Renders the unit by Embree on this thread and keeps every ray.
RecordedRays record_rays(const DeviceScene& embree_scene, const RenderUnit& unit, Isa isa);

/// Rays of the stage with a positive length.
std::size_t count_rays(RecordedStage& stage);

}  // namespace penumbra
