// The stages of denoising for one instruction set. Like native.cpp it is compiled several times and includes
// nothing from a standard library.
#include "kernels/denoise/denoise.h"

namespace penumbra {

void DENOISE_FUNCTION(const DenoiseTask& task, int tile, const float* guide, const float* sources,
                      float* models, float* scratch, float* out) {
  denoise_tile_of(&task, tile, guide, sources, models, scratch, out);
}

}  // namespace penumbra
