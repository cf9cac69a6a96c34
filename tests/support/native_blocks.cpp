#include "tests/support/native_blocks.h"

#include <algorithm>

namespace penumbra {

std::vector<float> render_native_blocks(const NativeKernel& kernel, const DeviceScene& scene,
                                        const RenderUnit& unit, int paths, const Tracer& tracer,
                                        const std::function<void(const NativeBlock&)>& before) {
  const Unit portable{unit.x, unit.y, unit.width, unit.height, unit.first_sample, int(unit.sample_count)};
  std::vector<float> floats(std::size_t(STATE_FLOATS) * std::size_t(paths)),
      slots(std::size_t(SLOT_FLOAT_COUNT) * std::size_t(paths));
  std::vector<int> ints(std::size_t(STATE_INTS) * std::size_t(paths));
  const Block block{floats.data(), ints.data(), slots.data(), paths, paths, nullptr};
  const int pixels = unit.width * unit.height, row = slot_pixels(paths, portable.sample_count, kernel.lanes);
  std::vector<float> planes(std::size_t(plane_count(scene.header.features)) * std::size_t(pixels));
  BadSamples bad[BAD_KINDS] = {};
  for (int first = 0; first < pixels; first += row) {
    if (before) before({first, row});
    kernel.render_block(scene.header, scene.words.data(), tracer, portable, first,
                        std::min(row, pixels - first), block, planes.data(), bad);
  }
  return planes;
}

}  // namespace penumbra
