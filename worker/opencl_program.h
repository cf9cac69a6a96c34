// Compiles the kernels for an OpenCL device.
#pragma once

#include <CL/cl.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "kernels/host/checked_cache.h"
#include "kernels/host/error.h"
#include "kernels/host/kernel_needs.h"
#include "worker/embedded_kernels.h"
#include "worker/opencl_devices.h"

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

/// The source of a program.
struct OpenClSource {
  std::string name;     ///< of the embedded file, for messages
  std::string text;     ///< with all includes inserted
  std::string options;  ///< compiler options
};

/// The source of an embedded file, from `files` or the kernels. `lanes`: paths per vectorised loop.
OpenClSource opencl_source(const OpenClDeviceInfo& device, std::string_view file,
                           std::span<const EmbeddedFile> files, const KernelNeeds& needs, int lanes);

/// Compiles it. The error includes the device's log.
Expected<ClProgram> compile_opencl(cl_context context, const OpenClDeviceInfo& device,
                                   const OpenClSource& source);
Expected<ClProgram> compile_opencl(cl_context context, const OpenClDeviceInfo& device, std::string_view file,
                                   std::span<const EmbeddedFile> files, const KernelNeeds& needs, int lanes);

/// The folder of compiled kernels: PENUMBRA_KERNEL_CACHE (off: none), else penumbra/kernels in the user's
/// cache.
std::filesystem::path default_kernel_cache();
/// A cache of compiled kernels, so that they are compiled once for each device and not at every start.
CheckedCache kernel_cache(std::filesystem::path folder);

/// The cache key of compiled source: text, options, device, driver and their versions.
std::string kernel_cache_key(const OpenClDeviceInfo& device, const OpenClSource& source);

/// A program from the cache. Null if there is none, or if the device rejects it; then it is removed, and
/// `note` says so.
ClProgram cached_program(cl_context context, const OpenClDeviceInfo& device, const OpenClSource& source,
                         const CheckedCache& cache, std::string& note);

/// Stores a program's binary. Drivers may finish compiling at the first launch only, so call it after that.
Expected<void> keep_program(cl_program program, const OpenClDeviceInfo& device, const OpenClSource& source,
                            const CheckedCache& cache);

/// The name of an error code, such as "CL_OUT_OF_RESOURCES".
std::string opencl_error_text(cl_int code);

}  // namespace penumbra
