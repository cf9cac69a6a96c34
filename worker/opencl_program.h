// Compiling the kernels for an OpenCL device.
#pragma once

#include <CL/cl.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "kernels/host/error.h"
#include "kernels/host/kernel_needs.h"
#include "worker/embedded_kernels.h"
#include "worker/opencl_cache.h"
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

/// A program as it is to be compiled.
struct OpenClSource {
  std::string name;     ///< of the embedded file, for messages
  std::string text;     ///< with its includes in place
  std::string options;  ///< for the compiler
};

/// The embedded file of that name, of `files` or the kernels. `lanes`: paths that one vectorised loop
/// carries.
OpenClSource opencl_source(const OpenClDeviceInfo& device, std::string_view file,
                           std::span<const EmbeddedFile> files, const KernelNeeds& needs, int lanes);

/// Compiles. The error holds the device's log.
Expected<ClProgram> compile_opencl(cl_context context, const OpenClDeviceInfo& device,
                                   const OpenClSource& source);
Expected<ClProgram> compile_opencl(cl_context context, const OpenClDeviceInfo& device, std::string_view file,
                                   std::span<const EmbeddedFile> files, const KernelNeeds& needs, int lanes);

/// What compiled source is kept under: its text, its options, and the device, its driver and their versions.
std::string kernel_cache_key(const OpenClDeviceInfo& device, const OpenClSource& source);

/// A program from the cache. None if there is none, or none that this device takes, which is then removed;
/// `note` says so.
ClProgram cached_program(cl_context context, const OpenClDeviceInfo& device, const OpenClSource& source,
                         const KernelCache& cache, std::string& note);

/// Keeps a program's binary. Drivers may compile a kernel at its first launch only: best after that.
Expected<void> keep_program(cl_program program, const OpenClDeviceInfo& device, const OpenClSource& source,
                            const KernelCache& cache);

/// "CL_OUT_OF_RESOURCES" and the like.
std::string opencl_error_text(cl_int code);

}  // namespace penumbra
