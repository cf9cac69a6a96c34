#include "kernels/host/native_denoise.h"

#include <utility>

namespace penumbra {

NativeDenoiseTile denoise_tile_sse2, denoise_tile_avx2, denoise_tile_avx512;

namespace {

constexpr std::pair<Isa, NativeDenoiseTile*> kTiles[] = {
#ifdef PENUMBRA_SSE2
    {Isa::kSse2, denoise_tile_sse2},
#endif
#ifdef PENUMBRA_AVX2
    {Isa::kAvx2, denoise_tile_avx2},
#endif
#ifdef PENUMBRA_AVX512
    {Isa::kAvx512, denoise_tile_avx512},
#endif
};

}  // namespace

NativeDenoiseTile* native_denoise_tile(Isa isa) {
  for (const auto& [target, tile] : kTiles)
    if (target == isa) return tile;
  return nullptr;
}

}  // namespace penumbra
