#include "kernels/host/native_denoise.h"

namespace penumbra {

NativeDenoiseTile denoise_tile_sse2, denoise_tile_avx2, denoise_tile_avx512;

NativeDenoiseTile* native_denoise_tile(Isa isa) {
  switch (isa) {
    case Isa::kSse2:
#ifdef PENUMBRA_SSE2
      return denoise_tile_sse2;
#else
      break;
#endif
    case Isa::kAvx2:
#ifdef PENUMBRA_AVX2
      return denoise_tile_avx2;
#else
      break;
#endif
    case Isa::kAvx512:
#ifdef PENUMBRA_AVX512
      return denoise_tile_avx512;
#else
      break;
#endif
  }
  return nullptr;
}

}  // namespace penumbra
