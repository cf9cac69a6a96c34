// The context and queue of a device, its buffers and launches, and their last error.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "kernels/unit.h"
#include "worker/device.h"
#include "worker/opencl_program.h"

namespace penumbra {

/// A buffer that is reused and grows when needed.
struct ClReserve {
  ClBuffer buffer;
  std::uint64_t bytes = 0;
};

/// Sets a kernel's arguments, in order.
class ClArguments {
 public:
  explicit ClArguments(cl_kernel kernel) : kernel_(kernel) {}
  ClArguments& operator<<(int value) { return set(&value, sizeof value); }
  ClArguments& operator<<(const ClBuffer& buffer) {
    const cl_mem memory = buffer.get();
    return set(&memory, sizeof memory);
  }
  ClArguments& operator<<(const ClReserve& reserve) { return *this << reserve.buffer; }
  ClArguments& operator<<(const Unit& unit) {
#define ADD_FIELD(type, name) *this << int(unit.name);
    UNIT_FIELDS(ADD_FIELD)
#undef ADD_FIELD
    return *this;
  }
  [[nodiscard]] cl_kernel kernel() const { return kernel_; }
  [[nodiscard]] cl_int status() const { return status_; }

 private:
  ClArguments& set(const void* value, std::size_t bytes) {
    if (status_ == CL_SUCCESS) status_ = clSetKernelArg(kernel_, at_++, bytes, value);
    return *this;
  }

  cl_kernel kernel_;
  cl_uint at_ = 0;
  cl_int status_ = CL_SUCCESS;
};

/// Functions that return bool return true on success; `error` describes the last failure. CPU devices use the
/// host's memory in place where they can, instead of copies.
class OpenClSession {
 public:
  explicit OpenClSession(OpenClDeviceInfo info) : info_(std::move(info)) {}
  OpenClSession(const OpenClSession&) = delete;
  OpenClSession& operator=(const OpenClSession&) = delete;
  ~OpenClSession() { wait(); }

  bool open();

  /// With `in_place` the data may be used without a copy: it must outlive the buffer.
  bool upload(ClBuffer& buffer, const void* data, std::size_t bytes, bool in_place);
  /// Initialised with zeros.
  bool allocate(ClBuffer& buffer, std::size_t bytes);
  /// Makes the buffer at least so large. Its content is kept if it was large enough, else it is zeros.
  bool reserve(ClReserve& reserve, std::uint64_t bytes);
  bool clear(const ClBuffer& buffer, std::size_t bytes);

  /// Launches at least `items` work items, rounded up to a multiple of `group`.
  bool launch(const ClArguments& arguments, std::size_t items, std::size_t group);
  /// Finds a program of that source, or compiles it. `start` takes the program, makes kernels of it and
  /// launches them: drivers may reject a binary, and finish compiling, as late as at the first launch. First
  /// it gets the cache's program, if there is one; if that does not start, it is removed from the cache. Else
  /// it gets a compiled one, which is kept in the cache once it has started; `before_compiling` is called
  /// before. Errors: it does not compile (with the device's log), or does not start.
  Expected<KernelOrigin> start_program(
      const OpenClSource& source, const CheckedCache& cache, const std::function<bool(ClProgram)>& start,
      const std::function<void()>& before_compiling = [] {});
  /// Waits for all launches, then copies the first `bytes` of a buffer.
  bool read(const ClReserve& from, void* to, std::size_t bytes);
  /// Waits until all launches are finished.
  bool wait() { return !queue_ || good(clFinish(queue_.get()), "wait for its kernels"); }

  /// The size of a work group, at most `most`: a multiple of what the device prefers.
  [[nodiscard]] std::size_t group_size(cl_kernel kernel, std::size_t most) const;

  bool good(cl_int status, std::string_view what);
  [[nodiscard]] Error error() const { return {message_}; }
  [[nodiscard]] const OpenClDeviceInfo& info() const { return info_; }
  [[nodiscard]] cl_context context() const { return context_.get(); }

 private:
  OpenClDeviceInfo info_;
  ClContext context_;
  ClQueue queue_;
  std::string message_;
};

}  // namespace penumbra
