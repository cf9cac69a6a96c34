// Denoises with Intel Open Image Denoise, where its shared library is installed. Nothing else depends on it.
#pragma once

#include "kernels/host/error.h"
#include "scheduler/denoise/denoise.h"

namespace penumbra {

/// HDR colour with albedo and normal, which are filtered first. The library is that of PENUMBRA_OIDN, or
/// libOpenImageDenoise.so of versions 1 or 2 where the loader finds it. Errors: there is none, or it fails.
/// There is no residual variance.
Expected<DenoisedImage> oidn(const DenoiseInput& input);

/// Whether the library is there.
Expected<void> check_oidn();

}  // namespace penumbra
