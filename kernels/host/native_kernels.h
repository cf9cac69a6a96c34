// The precompiled native variants of the block driver.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#ifndef EXTERNAL_TRACER
  #define EXTERNAL_TRACER
#endif
#include "kernels/scene.h"
#include "kernels/unit.h"

namespace penumbra {

/// See render_block of block.h.
using NativeRenderBlock = void(const SceneHeader& header, const uint* words, const Tracer& tracer,
                               const Unit& unit, int first_pixel, int pixels, const Block& block, float* out,
                               BadSamples* bad);

/// kScalar: one lane, no vector instructions beyond the baseline's; the block of one that debugging uses.
enum class KernelTarget { kScalar, kSse2, kAvx2, kAvx512 };

struct NativeKernel {
  KernelTarget target;
  std::string_view features_name;
  std::uint32_t features;  ///< FEATURE_* bits compiled in
  int lanes;
  NativeRenderBlock* render_block;
};

/// All variants in this binary.
std::span<const NativeKernel> native_kernels();

/// Whether this machine can run code built for the target.
bool machine_has(KernelTarget target);

/// The variant of the target that searches as the scene's features say; never null for a target of this
/// binary.
const NativeKernel* find_native_kernel(KernelTarget target, std::uint32_t features);

}  // namespace penumbra
