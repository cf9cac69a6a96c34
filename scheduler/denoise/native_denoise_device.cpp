#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "kernels/denoise/denoise.h"
#include "kernels/host/native_kernels.h"
#include "scheduler/denoise/denoise_devices.h"

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

}  // namespace penumbra
