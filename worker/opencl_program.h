// Finding an OpenCL device and compiling the kernels for it.
#pragma once

#include <CL/cl.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "kernels/host/error.h"
#include "worker/embedded_kernels.h"

namespace penumbra {

template <typename Handle, cl_int (*release)(Handle)>
struct ClRelease {
  void operator()(Handle handle) const { release(handle); }
};
template <typename Handle, cl_int (*release)(Handle)>
using ClHandle = std::unique_ptr<std::remove_pointer_t<Handle>, ClRelease<Handle, release>>;

using ClContext = ClHandle<cl_context, clReleaseContext>;
using ClQueue = ClHandle<cl_command_queue, clReleaseCommandQueue>;
using ClProgram = ClHandle<cl_program, clReleaseProgram>;
using ClKernel = ClHandle<cl_kernel, clReleaseKernel>;
using ClBuffer = ClHandle<cl_mem, clReleaseMemObject>;

struct OpenClDeviceInfo {
  cl_device_id id = nullptr;
  std::string platform, name;
  bool is_cpu = false;
  bool has_double = false;
  unsigned compute_units = 1;
  std::uint64_t memory_bytes = 0, max_allocation_bytes = 0;
};

/// All devices of all installed platforms.
std::vector<OpenClDeviceInfo> list_opencl_devices();

/// The first device whose platform or name contains `wanted` (any case); with an empty one the first CPU
/// device, else the first of all. The error lists what there is.
Expected<OpenClDeviceInfo> find_opencl_device(const std::string& wanted);

/// The embedded file of that name, of `files` or the kernels, with its includes in place, compiled. `lanes`:
/// paths that one vectorised loop carries.
Expected<ClProgram> compile_opencl(cl_context context, const OpenClDeviceInfo& device, std::string_view file,
                                   std::span<const EmbeddedFile> files, std::uint32_t features, int lanes);

/// The renderer's kernels.
Expected<ClProgram> compile_kernels(cl_context context, const OpenClDeviceInfo& device,
                                    std::uint32_t features, int lanes);

/// "CL_OUT_OF_RESOURCES (-5)" and the like.
std::string opencl_error_text(cl_int code);

}  // namespace penumbra
