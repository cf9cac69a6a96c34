#include <utility>

#include "kernels/denoise/denoise.h"
#include "scheduler/denoise/denoise_device.h"
#include "worker/opencl_session.h"

namespace penumbra {
namespace {

constexpr int kCpuLanes = 16;  // as in the worker's kernels
constexpr int kGpuItems = 256;

class OpenClDenoiseDevice final : public DenoiseDevice {
 public:
  OpenClDenoiseDevice(const OpenClDeviceInfo& info, int threads)
      : session_(info), items_(info.is_cpu ? threads : kGpuItems) {}

  Expected<void> set_up() {
    if (!session_.open()) return std::unexpected(session_.error());
    const OpenClDeviceInfo& info = session_.info();
    const OpenClSource source =
        opencl_source(info, "kernels/denoise.cl", {}, {}, info.is_cpu ? kCpuLanes : 1);
    const CheckedCache cache = kernel_cache(default_kernel_cache());
    const auto start = [this](ClProgram program) {
      kernel_.reset();
      program_ = std::move(program);
      cl_int status = CL_SUCCESS;
      kernel_.reset(clCreateKernel(program_.get(), "denoise_tiles", &status));
      return session_.good(status, "make the kernel of denoising");
    };
    if (auto started = session_.start_program(source, cache, start); !started)
      return std::unexpected(started.error());
    return {};
  }

  Expected<void> run(const DenoiseTask& task, std::span<const float> guide, std::span<const float> sources,
                     std::span<float> models, std::span<float> out) override {
    ClBuffer task_buffer, guide_buffer, source_buffer, model_buffer;
    const bool in_place = session_.info().is_cpu;
    const std::size_t scratch =
        sizeof(float) * std::size_t(items_) * std::size_t(denoise_scratch_floats(&task));
    const bool writes_models = task.stage == DENOISE_FIT;
    const bool ready =
        session_.upload(task_buffer, &task, sizeof task, false) &&
        session_.upload(guide_buffer, guide.data(), guide.size_bytes(), in_place) &&
        session_.upload(source_buffer, sources.data(), sources.size_bytes(), in_place) &&
        session_.reserve(scratch_, scratch) && session_.reserve(out_, 4 + out.size_bytes()) &&
        (writes_models ? session_.reserve(models_, models.size_bytes())
                       : session_.upload(model_buffer, models.data(), models.size_bytes(), in_place));
    if (!ready) return std::unexpected(session_.error());
    ClArguments arguments(kernel_.get());
    arguments << task_buffer << guide_buffer << source_buffer
              << (writes_models ? models_.buffer : model_buffer) << scratch_ << out_;
    const std::span<float> result = writes_models ? models : out;
    // The buffers above must not be released before the kernel has ended.
    const bool launched = session_.launch(arguments, std::size_t(items_), 1);
    if (!session_.wait() || !launched ||
        !session_.read(writes_models ? models_ : out_, result.data(), result.size_bytes()))
      return std::unexpected(session_.error());
    return {};
  }

 private:
  OpenClSession session_;
  int items_;
  ClProgram program_;
  ClKernel kernel_;
  ClReserve scratch_, out_, models_;
};

}  // namespace

Expected<std::unique_ptr<DenoiseDevice>> opencl_denoise_device(const OpenClDeviceInfo& info, int threads) {
  auto device = std::make_unique<OpenClDenoiseDevice>(info, threads);
  if (auto done = device->set_up(); !done) return std::unexpected(done.error());
  return device;
}

}  // namespace penumbra
