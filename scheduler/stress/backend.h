// The backends that compute the cases' quantities: the native kernels of each instruction set, and OpenCL.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/stress/case.h"
#include "worker/device.h"

namespace penumbra::stress {

class KernelRunner {
 public:
  virtual ~KernelRunner() = default;
  /// The outputs of each measurement, in order.
  virtual Expected<std::vector<Numbers>> run(std::span<const KernelMeasurement* const> measurements) = 0;
};

/// A way to run kernels, or why there is none.
struct Backend {
  std::string name;         ///< "native avx512", "native one lane", "opencl"
  std::string description;  ///< of the device
  std::unique_ptr<KernelRunner> kernels;
  DeviceOptions render;  ///< of renders
  bool renders = true;   ///< instruction sets between the widest and one lane answer kernel questions only
  std::string skipped;   ///< why this machine has none; empty: it has
  std::string broken;    ///< what went wrong with one that it has; every case fails
};

/// The native kernels for all instruction sets of this machine, the widest first and one lane last.
std::vector<Backend> native_backends(int threads);
/// OpenCL, or why there is none.
Backend opencl_backend(int threads, const std::string& device);

}  // namespace penumbra::stress
