// Runs the stages of denoising (kernels/denoise/) on all cores or on an OpenCL device. The results have the
// same bits.
#pragma once

#include <memory>
#include <span>

#include "kernels/denoise/denoise_task.h"
#include "kernels/host/error.h"
#include "kernels/host/isa.h"
#include "worker/device.h"
#include "worker/opencl_devices.h"

namespace penumbra {

class DenoiseDevice {
 public:
  virtual ~DenoiseDevice() = default;
  /// Runs all tiles of the task. `guide` and `sources` are whole images, see the stages in
  /// kernels/denoise/non_local_means.h and regression_tile.h.
  virtual Expected<void> run(const DenoiseTask& task, std::span<const float> guide,
                             std::span<const float> sources, std::span<float> models,
                             std::span<float> out) = 0;
};

/// The device for backend, threads (0: all cores), instruction set and OpenCL device. Backend::kAuto is
/// native. Errors: there is no such OpenCL device, or it cannot compile the kernels.
Expected<std::unique_ptr<DenoiseDevice>> make_denoise_device(const DeviceOptions& options);

/// One of usable_isas().
std::unique_ptr<DenoiseDevice> native_denoise_device(Isa isa, int threads);
Expected<std::unique_ptr<DenoiseDevice>> opencl_denoise_device(const OpenClDeviceInfo& info, int threads);

}  // namespace penumbra
