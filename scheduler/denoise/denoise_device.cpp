#include "scheduler/denoise/denoise_device.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "kernels/denoise/denoise.h"
#include "kernels/host/native_kernels.h"
#include "kernels/host/parallel.h"
#include "worker/native_device.h"

namespace penumbra {
namespace {

class NativeDenoiseDevice final : public DenoiseDevice {
 public:
  NativeDenoiseDevice(NativeDenoiseTile* tile, int threads) : tile_(tile), threads_(threads) {}

  Expected<void> run(const DenoiseTask& task, std::span<const float> guide, std::span<const float> sources,
                     std::span<float> models, std::span<float> out) override {
    const int tiles = denoise_tiles_of(&task);
    std::atomic<int> next = 0;
    const auto work = [&] {
      std::vector<float> scratch(std::size_t(denoise_scratch_floats(&task)));
      for (int tile = next++; tile < tiles; tile = next++)
        tile_(task, tile, guide.data(), sources.data(), models.data(), scratch.data(), out.data());
    };
    std::vector<std::jthread> others;
    for (int i = 1; i < std::min(threads_, tiles); ++i) others.emplace_back(work);
    work();
    return {};
  }

 private:
  NativeDenoiseTile* tile_;
  int threads_;
};

}  // namespace

std::unique_ptr<DenoiseDevice> native_denoise_device(Isa isa, int threads) {
  return std::make_unique<NativeDenoiseDevice>(native_denoise_tile(isa), std::max(threads, 1));
}

Expected<std::unique_ptr<DenoiseDevice>> make_denoise_device(const DeviceOptions& options) {
  const int threads = options.threads > 0 ? options.threads : int(core_count());
  if (options.backend != Backend::kOpenCl) {
    if (const Expected<void> usable = check_isa(options.isa); !usable) return std::unexpected(usable.error());
    return native_denoise_device(options.isa, threads);
  }
  const Expected<OpenClDeviceInfo> info = find_opencl_device(options.opencl_device);
  if (!info) return std::unexpected(info.error());
  return opencl_denoise_device(*info, threads);
}

}  // namespace penumbra
