#include "worker/opencl_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <utility>

#include "kernels/host/process.h"

namespace penumbra {

bool OpenClSession::open() {
  cl_int status = CL_SUCCESS;
  context_.reset(clCreateContext(nullptr, 1, &info_.id, nullptr, nullptr, &status));
  if (!good(status, "make a context")) return false;
  queue_.reset(clCreateCommandQueue(context_.get(), info_.id, 0, &status));
  if (!good(status, "make a queue")) return false;
  // Context and queue are never released: when the wait for the last command has returned, a thread of PoCL
  // 3.1 may still be releasing that command's event, which uses both.
  clRetainContext(context_.get());
  clRetainCommandQueue(queue_.get());
  return true;
}

bool OpenClSession::upload(ClBuffer& buffer, const void* data, std::size_t bytes, bool in_place) {
  static const cl_uint kNothing = 0;
  cl_int status = CL_SUCCESS;
  const void* from = bytes > 0 ? data : &kNothing;
  buffer.reset(clCreateBuffer(context_.get(),
                              CL_MEM_READ_ONLY | (in_place ? CL_MEM_USE_HOST_PTR : CL_MEM_COPY_HOST_PTR),
                              std::max(bytes, sizeof kNothing), const_cast<void*>(from), &status));
  return good(status, fmt::format("copy {} bytes to it", bytes));
}

bool OpenClSession::allocate(ClBuffer& buffer, std::size_t bytes) {
  cl_int status = CL_SUCCESS;
  // On a CPU device the buffer is in the host's memory, where mapping needs no copy.
  const cl_mem_flags place = info_.is_cpu ? CL_MEM_ALLOC_HOST_PTR : cl_mem_flags(0);
  buffer.reset(clCreateBuffer(context_.get(), CL_MEM_READ_WRITE | place, bytes, nullptr, &status));
  return good(status, fmt::format("allocate {} bytes on it", bytes)) && clear(buffer, bytes);
}

bool OpenClSession::reserve(ClReserve& reserve, std::uint64_t bytes) {
  if (bytes <= reserve.bytes) return true;
  if (!wait()) return false;
  reserve.buffer.reset();
  reserve.bytes = 0;
  if (!allocate(reserve.buffer, bytes)) return false;
  reserve.bytes = bytes;
  return true;
}

bool OpenClSession::clear(const ClBuffer& buffer, std::size_t bytes) {
  const cl_uint zero = 0;
  return good(clEnqueueFillBuffer(queue_.get(), buffer.get(), &zero, sizeof zero, 0, bytes / 4 * 4, 0,
                                  nullptr, nullptr),
              "clear its memory");
}

bool OpenClSession::launch(const ClArguments& arguments, std::size_t items, std::size_t group) {
  if (!good(arguments.status(), "set a kernel's arguments")) return false;
  const std::size_t global = std::max<std::size_t>((items + group - 1) / group, 1) * group;
  return good(clEnqueueNDRangeKernel(queue_.get(), arguments.kernel(), 1, nullptr, &global, &group, 0,
                                     nullptr, nullptr),
              "launch a kernel");
}

Expected<KernelOrigin> OpenClSession::start_program(const OpenClSource& source, const CheckedCache& cache,
                                                    const std::function<bool(ClProgram)>& start,
                                                    const std::function<void()>& before_compiling) {
  KernelOrigin origin;
  const auto begin = std::chrono::steady_clock::now();
  if (ClProgram program = cached_program(context(), info_, source, cache, origin.note)) {
    origin.cached = start(std::move(program));
    if (!origin.cached) {
      cache.remove(kernel_cache_key(info_, source));
      origin.note =
          fmt::format("{} cannot run the kernel cache's binary, which was removed: {}", info_.name, message_);
    }
  }
  cl_program compiled = nullptr;
  if (!origin.cached) {
    before_compiling();
    Expected<ClProgram> program = compile_opencl(context(), info_, source);
    if (!program) return std::unexpected(program.error());
    compiled = program->get();
    if (!start(std::move(*program))) return std::unexpected(error());
  }
  origin.seconds = seconds_since(begin);
  if (!origin.cached)
    if (const auto kept = keep_program(compiled, info_, source, cache); !kept)
      origin.note = "the kernels are not kept: " + kept.error().message;
  return origin;
}

bool OpenClSession::read(const ClReserve& from, void* to, std::size_t bytes) {
  if (!info_.is_cpu)
    return good(
        clEnqueueReadBuffer(queue_.get(), from.buffer.get(), CL_TRUE, 0, bytes, to, 0, nullptr, nullptr),
        "read back from it");
  cl_int status = CL_SUCCESS;
  void* mapped = clEnqueueMapBuffer(queue_.get(), from.buffer.get(), CL_TRUE, CL_MAP_READ, 0, bytes, 0,
                                    nullptr, nullptr, &status);
  if (!good(status, "read its memory")) return false;
  std::memcpy(to, mapped, bytes);
  return good(clEnqueueUnmapMemObject(queue_.get(), from.buffer.get(), mapped, 0, nullptr, nullptr),
              "read its memory");
}

std::size_t OpenClSession::group_size(cl_kernel kernel, std::size_t most) const {
  std::size_t allowed = 1, multiple = 1;
  clGetKernelWorkGroupInfo(kernel, info_.id, CL_KERNEL_WORK_GROUP_SIZE, sizeof allowed, &allowed, nullptr);
  clGetKernelWorkGroupInfo(kernel, info_.id, CL_KERNEL_PREFERRED_WORK_GROUP_SIZE_MULTIPLE, sizeof multiple,
                           &multiple, nullptr);
  most = std::clamp<std::size_t>(allowed, 1, most);
  return multiple > 0 && multiple <= most ? most / multiple * multiple : most;
}

bool OpenClSession::good(cl_int status, std::string_view what) {
  if (status == CL_SUCCESS) return true;
  message_ = fmt::format("{}: cannot {}: {}", info_.name, what, opencl_error_text(status));
  return false;
}

}  // namespace penumbra
