#include "worker/device.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "kernels/host/native_kernels.h"
#include "worker/native_device.h"
#include "worker/non_finite_source.h"
#include "worker/opencl_device.h"

namespace penumbra {

Expected<Isa> isa_from_name(std::string_view name) {
  for (std::size_t i = 0; i < kIsaNames.size(); ++i)
    if (kIsaNames[i] == name) return Isa(i);
  return fail("unknown instruction set '" + std::string(name) + "'; known: sse2, avx2, avx512");
}

Expected<void> check_backend_options(BackendsInUse backends, std::string_view opencl_device,
                                     std::string_view isa) {
  if (!opencl_device.empty() && !backends.opencl) {
    return fail(
        fmt::format("--device {}: only OpenCL has devices, and the backend is native; add --backend opencl",
                    opencl_device));
  }
  if (!isa.empty() && !backends.native) {
    return fail(fmt::format(
        "--isa {}: only the native backend has instruction sets, and the backend is opencl", isa));
  }
  return {};
}

std::vector<Isa> built_isas() {
  std::vector<Isa> isas;
  for (const NativeKernel& kernel : native_kernels()) isas.push_back(kernel.isa);
  return isas;
}

std::vector<Isa> usable_isas() {
  std::vector<Isa> isas = built_isas();
  std::erase_if(isas, [](Isa isa) { return !machine_has(isa); });
  return isas;
}

Isa best_isa() {
  const std::vector<Isa> usable = usable_isas();
  return usable.empty() ? built_isas().front() : usable.back();
}

Expected<void> check_isa(Isa isa) {
  const std::vector<Isa> usable = usable_isas();
  if (usable.empty())
    return fail(
        fmt::format("this build's native kernels are for {}, which this machine lacks; configure it with "
                    "-DPENUMBRA_ISA=all for every instruction set",
                    isa_list(built_isas())));
  if (!machine_has(isa))
    return fail(
        fmt::format("--isa {}: this machine lacks it; it can use {}", isa_name(isa), isa_list(usable)));
  if (find_native_kernel(isa) == nullptr)
    return fail(fmt::format(
        "--isa {}: this build has {} alone; configure it with -DPENUMBRA_ISA=all for every instruction set",
        isa_name(isa), isa_list(built_isas())));
  return {};
}

Expected<Isa> usable_isa(std::string_view name) {
  const Expected<Isa> isa = isa_from_name(name);
  if (!isa) return isa;
  if (const Expected<void> usable = check_isa(*isa); !usable) return std::unexpected(usable.error());
  return isa;
}

Expected<SampleBuffer> make_sample_buffer(const RenderUnit& unit, std::uint64_t features) {
  if (unit.width <= 0 || unit.height <= 0 || unit.sample_count == 0 || unit.sample_count > kMaxSamplesPerUnit)
    return fail(
        fmt::format("a unit of {}x{} pixels with {} samples cannot be rendered; samples go from 1 to {}",
                    unit.width, unit.height, unit.sample_count, kMaxSamplesPerUnit));
  SampleBuffer result;
  result.width = unit.width;
  result.height = unit.height;
  result.sample_count = unit.sample_count;
  result.planes = plane_count(features);
  result.values.resize(std::size_t(device_plane_count(features, unit.sample_count)) * result.pixels());
  return result;
}

namespace {

/// A native device in place of an unavailable one, with a warning.
class FallbackDevice final : public Device {
 public:
  FallbackDevice(std::unique_ptr<Device> device, std::string warning)
      : device_(std::move(device)), warning_(std::move(warning)) {}

  std::string description() const override { return device_->description(); }
  DevicePreparation preparation() const override { return {.kernels = {}, .warnings = {warning_}}; }
  Expected<SampleBuffer> render(const RenderUnit& unit) override { return device_->render(unit); }

 private:
  std::unique_ptr<Device> device_;
  std::string warning_;
};

Expected<std::unique_ptr<Device>> make_chosen_device(const DeviceScene& scene, const DeviceOptions& options) {
  if (scene.header.intersector == INTERSECTOR_EMBREE) return make_native_device(scene, options);
  std::vector<OpenClDeviceInfo> devices;
  if (options.opencl_device.empty()) {
    devices = suitable_opencl_devices(scene.header.features);
  } else {
    const Expected<OpenClDeviceInfo> named = find_opencl_device(options.opencl_device);
    if (!named) return std::unexpected(named.error());
    devices.push_back(*named);
  }
  if (devices.empty()) return make_native_device(scene, options);
  Expected<std::unique_ptr<Device>> device = make_opencl_device(scene, options, devices.front());
  if (device) return device;
  Expected<std::unique_ptr<Device>> native = make_native_device(scene, options);
  if (!native) return native;
  return std::make_unique<FallbackDevice>(
      std::move(*native),
      fmt::format("native code renders, since {} cannot: {}", devices.front().name, device.error().message));
}

Expected<std::unique_ptr<Device>> make_plain_device(const DeviceScene& scene, const DeviceOptions& options) {
  switch (options.backend) {
    case Backend::kNative:
      return make_native_device(scene, options);
    case Backend::kOpenCl:
      return make_opencl_device(scene, options);
    case Backend::kAuto:
      return make_chosen_device(scene, options);
  }
  return fail("no such backend");
}

}  // namespace

Expected<std::unique_ptr<Device>> make_device(const DeviceScene& scene, const DeviceOptions& options) {
  Expected<std::unique_ptr<Device>> device = make_plain_device(scene, options);
  if (!device) return device;
  return with_sources(std::move(*device), scene, options);
}

}  // namespace penumbra
