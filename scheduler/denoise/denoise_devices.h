// The implementations of DenoiseDevice.
#pragma once

#include <memory>

#include "kernels/host/native_kernels.h"
#include "scheduler/denoise/denoise_device.h"
#include "worker/opencl_devices.h"

namespace penumbra {

/// One of usable_isas().
std::unique_ptr<DenoiseDevice> native_denoise_device(Isa isa, int threads);
Expected<std::unique_ptr<DenoiseDevice>> opencl_denoise_device(const OpenClDeviceInfo& info, int threads);

}  // namespace penumbra
