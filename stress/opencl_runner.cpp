#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "kernels/features.h"
#include "stress/backend.h"
#include "stress/opencl_source.h"
#include "stress/quantity_list.h"
#include "worker/opencl_program.h"

namespace penumbra::stress {
namespace {

constexpr int kLanes = 16;  // as the worker's kernels on a CPU

std::string_view source_of(std::string_view name) {
  for (const auto files : {embedded_quantities(), embedded_kernels()}) {
    for (const EmbeddedFile& file : files) {
      if (file.name == name) return file.text;
    }
  }
  return {};  // a host header under a condition that OpenCL C never meets
}

/// Each file once.
void append_source(std::string_view name, std::set<std::string_view>& seen, std::string& source) {
  if (name == "kernels/lang_cpp.h" || !seen.insert(name).second) return;
  constexpr std::string_view kInclude = "#include \"";
  for (std::string_view text = source_of(name); !text.empty();) {
    const std::string_view line = text.substr(0, std::min(text.find('\n'), text.size() - 1) + 1);
    text.remove_prefix(line.size());
    const std::string_view directive = line.substr(std::min(line.find_first_not_of(' '), line.size()));
    if (directive.starts_with(kInclude))
      append_source(directive.substr(kInclude.size(), directive.rfind('"') - kInclude.size()), seen, source);
    else
      source += line;
  }
}

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
    // As in worker/opencl_device.cpp: a thread of PoCL may use them a little longer.
    clRetainContext(context_.get());
    clRetainCommandQueue(queue_.get());
    const std::string text = opencl_quantities();
    const char* source = text.c_str();
    program_.reset(clCreateProgramWithSource(context_.get(), 1, &source, nullptr, &status));
    cl_device_fp_config single = 0;
    clGetDeviceInfo(info.id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof single, &single, nullptr);
    std::string options = fmt::format("-w -DFEATURES={} -DLANES={}", FEATURE_ALL, info.is_cpu ? kLanes : 1);
    if ((single & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0)
      options += " -cl-fp32-correctly-rounded-divide-sqrt";
    status = clBuildProgram(program_.get(), 1, &info.id, options.c_str(), nullptr, nullptr);
    if (status != CL_SUCCESS) {
      std::size_t size = 0;
      clGetProgramBuildInfo(program_.get(), info.id, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
      std::string log(size, '\0');
      clGetProgramBuildInfo(program_.get(), info.id, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
      return fail(fmt::format("the quantities do not compile on {}: {}\n{}", info.name,
                              opencl_error_text(status), log.c_str()));
    }
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

std::string opencl_quantities() {
  std::set<std::string_view> seen;
  std::string source;
  append_source("stress/quantities.cl", seen, source);
  return source;
}

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
