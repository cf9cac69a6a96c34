#include "kernels/host/native_denoise.h"

namespace penumbra {

NativeDenoiseTile denoise_tile_scalar, denoise_tile_sse2, denoise_tile_avx2, denoise_tile_avx512;

NativeDenoiseTile* native_denoise_tile(KernelTarget target) {
  switch (target) {
#ifdef PENUMBRA_AVX512
    case KernelTarget::kAvx512:
      return denoise_tile_avx512;
#endif
#ifdef PENUMBRA_AVX2
    case KernelTarget::kAvx2:
      return denoise_tile_avx2;
#endif
    case KernelTarget::kScalar:
      return denoise_tile_scalar;
    default:
      return denoise_tile_sse2;
  }
}

}  // namespace penumbra
