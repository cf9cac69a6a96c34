// The stages of the portable intersector, compiled like the workers' kernels.
#pragma once

#include "kernels/host/device_scene.h"
#include "worker/device.h"

namespace penumbra {

/// Traces the rays of `count` lanes or, with `occlude`, their shadow rays. `together`: they are a camera's.
using PortableStage = void(const SceneHeader& header, const uint* words, bool occlude, bool together,
                           const PathState* paths, int count);

PortableStage portable_stage_sse2, portable_stage_avx2, portable_stage_avx512;

}  // namespace penumbra
