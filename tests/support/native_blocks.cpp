#include "tests/support/native_blocks.h"

#include <algorithm>

#include "kernels/host/block_memory.h"
#include "kernels/host/photon_map_builder.h"
#include "worker/kernel_unit.h"

namespace penumbra {

AlignedVector<std::uint32_t> native_photon_maps(const NativeKernel& kernel, const DeviceScene& scene,
                                                const Block& block, std::uint32_t first_sample,
                                                const Tracer& tracer) {
  if (scene.header.integrator.photons == PHOTONS_NONE) return {};
  const PhotonTask task = photon_task(scene.header.integrator, first_sample, 0);
  std::vector<Photon> photons;
  int count = 0;
  do {
    photons.resize(std::size_t(std::max(count, 1)));
    count = 0;
    for (int first = 0; first < task.paths; first += block.paths.capacity)
      kernel.trace_photons(scene.header, scene.words.data(), tracer, task, first,
                           std::min(block.paths.capacity, task.paths - first), block,
                           {photons.data(), &count, int(photons.size())});
  } while (std::size_t(count) > photons.size());
  photons.resize(std::size_t(count));
  return build_photon_maps(scene.header, task, photons);
}

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
  const AlignedVector<std::uint32_t> photons =
      native_photon_maps(kernel, scene, block, unit.first_sample, tracer);
  for (int first = 0; first < pixels; first += row) {
    if (before) before({first, row});
    kernel.render_block(scene.header, scene.words.data(), photons.data(), tracer, portable, first,
                        std::min(row, pixels - first), block, planes.data(), bad);
  }
  return planes;
}

}  // namespace penumbra
