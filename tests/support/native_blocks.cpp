#include "tests/support/native_blocks.h"

#include <algorithm>

#include "kernels/host/block_memory.h"
#include "worker/kernel_unit.h"

namespace penumbra {

std::vector<float> render_native_blocks(const NativeKernel& kernel, const DeviceScene& scene,
                                        const RenderUnit& unit, int paths, const Tracer& tracer,
                                        const std::function<void(const NativeBlock&)>& before) {
  const Unit portable = kernel_unit(unit);
  BlockMemory memory(scene.header.features, paths, paths);
  const Block block = memory.block();
  const int pixels = unit.width * unit.height, row = slot_pixels(paths, portable.sample_count, kernel.lanes);
  std::vector<float> planes(std::size_t(device_plane_count(scene.header.features, unit.sample_count)) *
                            std::size_t(pixels));
  BadSamples bad[BAD_KINDS] = {};
  for (int first = 0; first < pixels; first += row) {
    if (before) before({first, row});
    kernel.render_block(scene.header, scene.words.data(), nullptr, tracer, portable, first,
                        std::min(row, pixels - first), block, planes.data(), bad);
  }
  return planes;
}

}  // namespace penumbra
