// The OpenCL devices of this machine, and the choice of one.
#pragma once

#include <CL/cl.h>

#include <cstdint>
#include <string>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

struct OpenClDeviceInfo {
  cl_device_id id = nullptr;
  std::string platform, name;
  bool is_cpu = false;
  bool has_double = false;
  unsigned compute_units = 1;
  std::uint64_t memory_bytes = 0, max_allocation_bytes = 0;
  bool is_exact = false;          ///< float arithmetic like a CPU's: the same bits as native code
  bool limits_registers = false;  ///< supports -cl-nv-maxrregcount
  std::string version;            ///< of OpenCL: "OpenCL 1.2 ..."
  std::string compiler_identity;  ///< vendors, drivers and versions for which a compiled kernel is valid
};

/// All devices of all installed platforms that can compile and run OpenCL C 1.2 kernels.
std::vector<OpenClDeviceInfo> list_opencl_devices();

/// The device with that number in the list, else the first whose platform or name contains `wanted` (case
/// ignored). If `wanted` is empty: the first CPU device, else the first device. The error lists all devices.
Expected<OpenClDeviceInfo> find_opencl_device(const std::string& wanted);

/// Devices for a render that leaves the choice to the machine, in order: not a CPU (these run native code
/// better), with exact arithmetic, and with all that the scene's features need. Empty if there are none.
std::vector<OpenClDeviceInfo> suitable_opencl_devices(std::uint64_t features);

/// Why kernels with these features cannot run on the device, or empty.
std::string lacking_for(const OpenClDeviceInfo& device, std::uint64_t features);

/// One line for each device: "0  Portable Computing Language: pthread-... (CPU, 2 units, 14.5 GB, double
/// precision)".
std::string opencl_device_table(const std::vector<OpenClDeviceInfo>& devices);

}  // namespace penumbra
