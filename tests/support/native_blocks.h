// Calls one native variant of the kernels block by block, without a device.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "kernels/host/cache_aligned.h"
#include "kernels/host/native_kernels.h"
#include "worker/device.h"

namespace penumbra {

/// A block that is about to be rendered: its first pixel of the unit, and the pixels in a row of its slots
/// (see slot_pixels).
struct NativeBlock {
  int first_pixel = 0, row = 0;
};

/// The words of the photon maps for a unit with that first sample, of photons that this variant traces in the
/// block; empty for scenes without photons.
AlignedVector<std::uint32_t> native_photon_maps(const NativeKernel& kernel, const DeviceScene& scene,
                                                const Block& block, std::uint32_t first_sample,
                                                const Tracer& tracer = {});

/// The unit's planes, those that the scene's features ask for, by this variant whatever a device would
/// choose: on this thread, `paths` paths under way at once, with memory for all features. `tracer` as in
/// native_kernels.h; `before` may be empty.
std::vector<float> render_native_blocks(const NativeKernel& kernel, const DeviceScene& scene,
                                        const RenderUnit& unit, int paths, const Tracer& tracer = {},
                                        const std::function<void(const NativeBlock&)>& before = {});

}  // namespace penumbra
