// The stages of denoising as native code, for each instruction set in this build.
#pragma once

#include "kernels/denoise/denoise_task.h"
#include "kernels/host/native_kernels.h"

namespace penumbra {

/// See denoise_tile_of of denoise/denoise.h.
using NativeDenoiseTile = void(const DenoiseTask& task, int tile, const float* guide, const float* sources,
                               float* models, float* scratch, float* out);

/// The code for the set; null if this binary has none.
NativeDenoiseTile* native_denoise_tile(Isa isa);

}  // namespace penumbra
