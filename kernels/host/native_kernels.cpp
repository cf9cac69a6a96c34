#include "kernels/host/native_kernels.h"

#include <utility>

namespace penumbra {

NativeRenderBlock render_block_sse2, render_block_avx2, render_block_avx512;
NativeDenoiseTile denoise_tile_sse2, denoise_tile_avx2, denoise_tile_avx512;
NativeTracePhotons trace_photons_sse2, trace_photons_avx2, trace_photons_avx512;

namespace {

constexpr int kVectorLanes = 16;

// CMakeLists.txt decides which of them this build has.
constexpr NativeKernel kKernels[] = {
#ifdef PENUMBRA_SSE2
    {Isa::kSse2, kVectorLanes, render_block_sse2, trace_photons_sse2},
#endif
#ifdef PENUMBRA_AVX2
    {Isa::kAvx2, kVectorLanes, render_block_avx2, trace_photons_avx2},
#endif
#ifdef PENUMBRA_AVX512
    {Isa::kAvx512, kVectorLanes, render_block_avx512, trace_photons_avx512},
#endif
};

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

std::span<const NativeKernel> native_kernels() { return kKernels; }

bool machine_has(Isa isa) {
  switch (isa) {
    case Isa::kSse2:
      return true;  // the x86-64 baseline
    case Isa::kAvx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") &&
             __builtin_cpu_supports("fma");
    case Isa::kAvx512:
      return machine_has(Isa::kAvx2) && __builtin_cpu_supports("avx512f") &&
             __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  }
  return false;
}

const NativeKernel* find_native_kernel(Isa isa) {
  for (const NativeKernel& kernel : kKernels)
    if (kernel.isa == isa) return &kernel;
  return nullptr;
}

NativeDenoiseTile* native_denoise_tile(Isa isa) {
  for (const auto& [target, tile] : kTiles)
    if (target == isa) return tile;
  return nullptr;
}

}  // namespace penumbra
