// The OpenCL devices of this machine, and choosing one.
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
  bool is_exact = false;          ///< float arithmetic as a CPU's: the same bits as native code
  bool limits_registers = false;  ///< takes -cl-nv-maxrregcount
  std::string version;            ///< of OpenCL, "OpenCL 1.2 ..."
  std::string compiler_identity;  ///< vendors, drivers and versions: what a compiled kernel is only good for
};

/// All devices of all installed platforms that can compile and run kernels of OpenCL C 1.2.
std::vector<OpenClDeviceInfo> list_opencl_devices();

/// The device of that number in the list, else the first whose platform or name contains `wanted` (any case);
/// with an empty one the first CPU device, else the first of all. The error lists what there is.
Expected<OpenClDeviceInfo> find_opencl_device(const std::string& wanted);

/// A device for a render that left the choice to the machine: the first that is no CPU (those run native code
/// better), whose arithmetic is exact, and which has what the scene's features need. Nothing if there is
/// none.
std::vector<OpenClDeviceInfo> suitable_opencl_devices(std::uint64_t features);

/// Why no kernel with these features runs on the device, or an empty text.
std::string lacking_for(const OpenClDeviceInfo& device, std::uint64_t features);

/// "0  Portable Computing Language: pthread-... (CPU, 2 units, 14.5 GB, double precision)", a line for each.
std::string opencl_device_table(const std::vector<OpenClDeviceInfo>& devices);

}  // namespace penumbra
