// The portable intersector's stages alone, compiled as the workers' kernels are.
#pragma once

#include "kernels/host/device_scene.h"
#include "worker/device.h"

namespace penumbra {

/// Fills HIT of `count` lanes for their rays or, with `occlude`, their shadow rays.
using PortableStage = void(const SceneHeader& header, const uint* words, bool occlude, float* f, int* ints,
                           int capacity, int count);

PortableStage portable_stage_avx2_core, portable_stage_avx2_core_bvh, portable_stage_avx512_core,
    portable_stage_avx512_core_bvh;

}  // namespace penumbra
