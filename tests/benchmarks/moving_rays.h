// The portable traversal of what moves, compiled like the workers' kernels.
#pragma once

#include "kernels/host/device_scene.h"

namespace penumbra {

/// A ray at a time while the shutter is open.
struct MovingRayCase {
  vec3 origin, direction;
  float time = 0;
};

/// Traces the rays. `any`: as shadow rays. Returns the number of those that hit what moves.
using MovingRayStage = int(const SceneHeader& header, const uint* words, bool any, const MovingRayCase* rays,
                           int count);

MovingRayStage moving_ray_stage_sse2, moving_ray_stage_avx2, moving_ray_stage_avx512;

}  // namespace penumbra
