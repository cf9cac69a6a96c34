#include "worker/device.h"

#include <fmt/format.h>

#include "kernels/host/native_kernels.h"
#include "worker/native_device.h"
#include "worker/non_finite_stage.h"
#include "worker/opencl_device.h"

namespace penumbra {

Expected<Isa> isa_from_name(std::string_view name) {
  for (std::size_t i = 0; i < kIsaNames.size(); ++i)
    if (kIsaNames[i] == name) return Isa(i);
  return fail("unknown instruction set '" + std::string(name) + "'; known: sse2, avx2, avx512");
}

Isa best_isa() {
  if (machine_has(KernelTarget::kAvx512)) return Isa::kAvx512;
  return machine_has(KernelTarget::kAvx2) ? Isa::kAvx2 : Isa::kSse2;
}

Expected<SampleBuffer> make_sample_buffer(const RenderUnit& unit, std::uint32_t features) {
  if (unit.width <= 0 || unit.height <= 0 || unit.sample_count == 0 || unit.sample_count > kMaxSamplesPerUnit)
    return fail(
        fmt::format("a unit of {}x{} pixels with {} samples cannot be rendered; samples go from 1 to {}",
                    unit.width, unit.height, unit.sample_count, kMaxSamplesPerUnit));
  SampleBuffer result;
  result.width = unit.width;
  result.height = unit.height;
  result.sample_count = unit.sample_count;
  result.planes = plane_count(features);
  result.values.resize(std::size_t(result.planes) * result.pixels());
  return result;
}

Expected<std::unique_ptr<Device>> make_device(const DeviceScene& scene, const DeviceOptions& options) {
  Expected<std::unique_ptr<Device>> device = options.backend == Backend::kOpenCl
                                                 ? make_opencl_device(scene, options)
                                                 : make_native_device(scene, options);
  if (!device) return device;
  return with_stages(std::move(*device), scene, options);
}

}  // namespace penumbra
