#include "kernels/host/native_kernels.h"

#include "kernels/native_variants.h"

namespace penumbra {

#define TARGET_FUNCTION(target, set) render_block_##target##_##set
// A build with sanitizers has one vector set, which stands for all.
#ifdef ONE_VECTOR_TARGET
  #define VECTOR_FUNCTION(target, set) TARGET_FUNCTION(sse2, set)
#else
  #define VECTOR_FUNCTION(target, set) TARGET_FUNCTION(target, set)
#endif
#define DECLARE_SET(set)                                                                                  \
  NativeRenderBlock TARGET_FUNCTION(scalar, set), TARGET_FUNCTION(sse2, set), VECTOR_FUNCTION(avx2, set), \
      VECTOR_FUNCTION(avx512, set);
NATIVE_FEATURE_SETS(DECLARE_SET)
#undef DECLARE_SET

namespace {

constexpr int kVectorLanes = 16;

#define LIST_SCALAR(set) \
  {KernelTarget::kScalar, #set, NATIVE_FEATURES_##set, 1, TARGET_FUNCTION(scalar, set)},
#define LIST_SSE2(set) \
  {KernelTarget::kSse2, #set, NATIVE_FEATURES_##set, kVectorLanes, TARGET_FUNCTION(sse2, set)},
#define LIST_AVX2(set) \
  {KernelTarget::kAvx2, #set, NATIVE_FEATURES_##set, kVectorLanes, VECTOR_FUNCTION(avx2, set)},
#define LIST_AVX512(set) \
  {KernelTarget::kAvx512, #set, NATIVE_FEATURES_##set, kVectorLanes, VECTOR_FUNCTION(avx512, set)},

constexpr NativeKernel kKernels[] = {NATIVE_FEATURE_SETS(LIST_SCALAR) NATIVE_FEATURE_SETS(LIST_SSE2)
                                         NATIVE_FEATURE_SETS(LIST_AVX2) NATIVE_FEATURE_SETS(LIST_AVX512)};

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

const NativeKernel* find_native_kernel(KernelTarget target, std::uint32_t features) {
  for (const NativeKernel& kernel : kKernels) {
    // The hierarchy replaces testing every primitive; the other features are compiled in.
    const bool same_search = ((kernel.features ^ features) & FEATURE_BVH) == 0;
    if (kernel.target == target && same_search) return &kernel;
  }
  return nullptr;
}

}  // namespace penumbra
