#include "kernels/host/native_kernels.h"

namespace penumbra {

NativeRenderBlock render_block_scalar, render_block_sse2, render_block_avx2, render_block_avx512;
NativeTracePhotons trace_photons_scalar, trace_photons_sse2, trace_photons_avx2, trace_photons_avx512;

namespace {

constexpr int kVectorLanes = 16;

// CMakeLists.txt decides which of them this build has.
constexpr NativeKernel kKernels[] = {
    {KernelTarget::kScalar, 1, render_block_scalar, trace_photons_scalar},
    {KernelTarget::kSse2, kVectorLanes, render_block_sse2, trace_photons_sse2},
#ifdef PENUMBRA_AVX2
    {KernelTarget::kAvx2, kVectorLanes, render_block_avx2, trace_photons_avx2},
#endif
#ifdef PENUMBRA_AVX512
    {KernelTarget::kAvx512, kVectorLanes, render_block_avx512, trace_photons_avx512},
#endif
};

}  // namespace

std::span<const NativeKernel> native_kernels() { return kKernels; }

bool machine_has(KernelTarget target) {
  switch (target) {
    case KernelTarget::kScalar:
    case KernelTarget::kSse2:
      return true;  // the x86-64 baseline
    case KernelTarget::kAvx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") &&
             __builtin_cpu_supports("fma");
    case KernelTarget::kAvx512:
      return machine_has(KernelTarget::kAvx2) && __builtin_cpu_supports("avx512f") &&
             __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  }
  return false;
}

const NativeKernel* find_native_kernel(KernelTarget target) {
  for (const NativeKernel& kernel : kKernels)
    if (kernel.target == target) return &kernel;
  return nullptr;
}

}  // namespace penumbra
