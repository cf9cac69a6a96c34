#include "scheduler/denoise/denoise_device.h"

#include "kernels/host/parallel.h"
#include "scheduler/denoise/denoise_devices.h"
#include "worker/native_device.h"

namespace penumbra {

Expected<std::unique_ptr<DenoiseDevice>> make_denoise_device(const DeviceOptions& options) {
  const int threads = options.threads > 0 ? options.threads : int(core_count());
  if (options.backend != Backend::kOpenCl) {
    if (const Expected<void> usable = check_isa(options.isa); !usable) return std::unexpected(usable.error());
    return native_denoise_device(options.isa, threads);
  }
  const Expected<OpenClDeviceInfo> info = find_opencl_device(options.opencl_device);
  if (!info) return std::unexpected(info.error());
  return opencl_denoise_device(*info, threads);
}

}  // namespace penumbra
