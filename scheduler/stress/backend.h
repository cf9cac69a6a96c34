// The backends on which cases are run: the native kernels for each instruction set, and OpenCL.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/stress/case.h"
#include "worker/device.h"
#include "worker/embedded_kernels.h"

namespace penumbra::stress {

class KernelRunner {
 public:
  virtual ~KernelRunner() = default;
  /// Returns the outputs of all measurements, in order.
  virtual Expected<std::vector<Numbers>> run(std::span<const KernelMeasurement* const> measurements) = 0;
};

/// A backend, or why it is not available.
struct Backend {
  std::string name;         ///< "native avx512", "native one lane", "opencl"
  std::string description;  ///< description of the device
  std::unique_ptr<KernelRunner> kernels;
  DeviceOptions render;  ///< device options for renders
  /// False for instruction sets below the widest: they run only kernel measurements.
  bool renders = true;
  std::string skipped;  ///< why this machine does not have the backend; empty if it has
  std::string broken;   ///< the error of a backend that exists but does not work; every case fails
};

/// The native kernels for all usable instruction sets, the widest first; last a single lane, with renders by
/// blocks of one pixel.
std::vector<Backend> native_backends(int threads);
/// The source of the quantities for OpenCL compilers: quantities.cl and the files of this folder that it
/// includes, unchanged.
std::span<const EmbeddedFile> embedded_quantities();

/// OpenCL, or why it is not available.
Backend opencl_backend(int threads, const std::string& device);

}  // namespace penumbra::stress
