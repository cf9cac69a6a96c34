// The block driver and the stages of denoising as native code, for each instruction set in this build.
#pragma once

#include <cstdint>
#include <span>

#ifndef EXTERNAL_TRACER
  #define EXTERNAL_TRACER
#endif
#include "kernels/denoise/denoise_task.h"
#include "kernels/host/isa.h"
#include "kernels/photon/photon_task.h"
#include "kernels/scene.h"
#include "kernels/unit.h"

namespace penumbra {

/// See render_block of block.h. `photons`: the maps, see photon/photon_map.h; null for scenes without
/// photons.
using NativeRenderBlock = void(const SceneHeader& header, const uint* words, const uint* photons,
                               const Tracer& tracer, const Unit& unit, int first_pixel, int pixels,
                               const Block& block, float* out, BadSamples* bad);
/// See trace_photons of photon/trace_photons.h.
using NativeTracePhotons = void(const SceneHeader& header, const uint* words, const Tracer& tracer,
                                const PhotonTask& task, int first, int count, const Block& block,
                                const PhotonStore& store);

struct NativeKernel {
  Isa isa;
  int lanes;
  NativeRenderBlock* render_block;
  NativeTracePhotons* trace_photons;
};

/// The kernels that the build was configured for, the narrowest instruction set first: at least one.
std::span<const NativeKernel> native_kernels();

/// Whether this machine can run code that was compiled for the set.
bool machine_has(Isa isa);

/// Null if this binary has no kernel for the set.
const NativeKernel* find_native_kernel(Isa isa);

/// Bytes of machine code and constants in the kernel's object file.
std::uint64_t native_code_bytes(const NativeKernel& kernel);

/// See denoise_tile_of of denoise/denoise.h.
using NativeDenoiseTile = void(const DenoiseTask& task, int tile, const float* guide, const float* sources,
                               float* models, float* scratch, float* out);

/// The stages of denoising for the set; null if this binary has none.
NativeDenoiseTile* native_denoise_tile(Isa isa);

}  // namespace penumbra
