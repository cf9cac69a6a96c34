#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "kernels/features.h"
#include "scheduler/stress/backend.h"
#include "scheduler/stress/quantity_list.h"
#include "worker/opencl_program.h"

namespace penumbra::stress {
namespace {

constexpr int kLanes = 16;  // the same as the worker's kernels on a CPU

class OpenClRunner final : public KernelRunner {
 public:
  ~OpenClRunner() override {
    if (queue_) clFinish(queue_.get());
  }

  Expected<void> set_up(const OpenClDeviceInfo& info) {
    cl_int status = CL_SUCCESS;
    context_.reset(clCreateContext(nullptr, 1, &info.id, nullptr, nullptr, &status));
    if (status != CL_SUCCESS) return fail("cannot use " + info.name + ": " + opencl_error_text(status));
    queue_.reset(clCreateCommandQueue(context_.get(), info.id, 0, &status));
    if (status != CL_SUCCESS) return fail("cannot use " + info.name + ": " + opencl_error_text(status));
    // As in worker/opencl_device.cpp: a PoCL thread may use these a little longer.
    clRetainContext(context_.get());
    clRetainCommandQueue(queue_.get());
    Expected<ClProgram> program = compile_opencl(context_.get(), info, "scheduler/stress/quantities.cl",
                                                 embedded_quantities(), {}, info.is_cpu ? kLanes : 1);
    if (!program) return std::unexpected(program.error());
    program_ = std::move(*program);
    kernel_.reset(clCreateKernel(program_.get(), "answer", &status));
    if (status != CL_SUCCESS) return fail("cannot create the kernel: " + opencl_error_text(status));
    return {};
  }

  Expected<std::vector<Numbers>> run(std::span<const KernelMeasurement* const> measurements) override {
    const std::size_t count = measurements.size();
    std::vector<int> ids(count);
    std::vector<double> in(count * QUANTITY_INPUTS), out(count * QUANTITY_OUTPUTS);
    for (std::size_t i = 0; i < count; ++i) {
      ids[i] = measurements[i]->quantity;
      std::copy(measurements[i]->inputs.begin(), measurements[i]->inputs.end(),
                in.begin() + std::ptrdiff_t(i * QUANTITY_INPUTS));
    }
    cl_int status = CL_SUCCESS;
    const auto buffer = [&](void* data, std::size_t bytes) {
      cl_int made = CL_SUCCESS;
      ClBuffer result(clCreateBuffer(context_.get(),
                                     CL_MEM_READ_WRITE | (data ? CL_MEM_COPY_HOST_PTR : cl_mem_flags(0)),
                                     bytes, data, &made));
      if (made != CL_SUCCESS) status = made;
      return result;
    };
    ClBuffer id_buffer = buffer(ids.data(), ids.size() * sizeof(int));
    ClBuffer in_buffer = buffer(in.data(), in.size() * sizeof(double));
    ClBuffer out_buffer = buffer(out.data(), out.size() * sizeof(double));
    ClBuffer scratch = buffer(nullptr, count * QUANTITY_SCRATCH * sizeof(cl_uint));
    cl_uint argument = 0;
    for (const ClBuffer* b : {&id_buffer, &in_buffer, &out_buffer, &scratch}) {
      const cl_mem memory = b->get();
      if (status == CL_SUCCESS) status = clSetKernelArg(kernel_.get(), argument++, sizeof memory, &memory);
    }
    const std::size_t local = 1;
    if (status == CL_SUCCESS)
      status = clEnqueueNDRangeKernel(queue_.get(), kernel_.get(), 1, nullptr, &count, &local, 0, nullptr,
                                      nullptr);
    if (status == CL_SUCCESS)
      status = clEnqueueReadBuffer(queue_.get(), out_buffer.get(), CL_TRUE, 0, out.size() * sizeof(double),
                                   out.data(), 0, nullptr, nullptr);
    clFinish(queue_.get());
    if (status != CL_SUCCESS) return fail("cannot run the quantities: " + opencl_error_text(status));
    std::vector<Numbers> results;
    for (std::size_t i = 0; i < count; ++i) {
      const auto first = out.begin() + std::ptrdiff_t(i * QUANTITY_OUTPUTS);
      results.emplace_back(first, first + QUANTITY_OUTPUTS);
    }
    return results;
  }

 private:
  ClContext context_;
  ClQueue queue_;
  ClProgram program_;
  ClKernel kernel_;
};

}  // namespace

Backend opencl_backend(int threads, const std::string& device) {
  Backend backend;
  backend.name = backend.description = "opencl";
  backend.render.backend = penumbra::Backend::kOpenCl;
  backend.render.threads = threads;
  backend.render.opencl_device = device;
  const Expected<OpenClDeviceInfo> info = find_opencl_device(device);
  if (!info) {
    backend.skipped = info.error().message;
    return backend;
  }
  backend.description = fmt::format("opencl: {} ({})", info->name, info->platform);
  if (!info->has_double) {
    backend.skipped = info->name + " has no double precision, which closed forms need";
    return backend;
  }
  auto runner = std::make_unique<OpenClRunner>();
  if (Expected<void> done = runner->set_up(*info); !done)
    backend.broken = done.error().message;
  else
    backend.kernels = std::move(runner);
  return backend;
}

}  // namespace penumbra::stress
