#include "worker/non_finite_source.h"

#include <utility>

#include "worker/native_device.h"

namespace penumbra {
namespace {

class DeviceWithStages final : public Device {
 public:
  DeviceWithStages(std::unique_ptr<Device> device, const DeviceScene& scene, const DeviceOptions& options)
      : device_(std::move(device)), scene_(scene), options_(options) {
    if (options_.backend != Backend::kNative) options_.isa = best_isa();  // the job's need not be there
    options_.backend = Backend::kNative;
    options_.threads = 1;
    options_.block_of_one = true;
    options_.probe = probe_;
  }

  std::string description() const override { return device_->description(); }
  DevicePreparation preparation() const override { return device_->preparation(); }

  Expected<SampleBuffer> render(const RenderUnit& unit) override {
    Expected<SampleBuffer> result = device_->render(unit);
    if (!result) return result;
    for (const int kind : {BAD_NAN, BAD_INFINITE})
      if (FlaggedSamples& bad = result->flagged[std::size_t(kind)]; bad.count > 0)
        bad.source = source_of(unit, bad);
    return result;
  }

  std::uint64_t parts_done() const override { return device_->parts_done(); }

  Expected<void> take_view() override {
    if (prober_)
      if (Expected<void> taken = prober_->take_view(); !taken) return taken;
    return device_->take_view();
  }

 private:
  /// Unknown if the path cannot be repeated, or is finite natively; the unit is still valid.
  NonFiniteSource source_of(const RenderUnit& unit, const FlaggedSamples& bad) {
    if (!prober_) {
      Expected<std::unique_ptr<Device>> made = make_native_device(scene_, options_);
      if (!made) return {};
      prober_ = std::move(*made);
    }
    probe_[0] = SOURCE_UNKNOWN;
    probe_[1] = 0;
    RenderUnit sample = unit;
    sample.x = bad.x;
    sample.y = bad.y;
    sample.width = sample.height = 1;
    sample.first_sample = bad.sample;
    sample.sample_count = 1;
    if (!prober_->render(sample)) return {};
    return {probe_[0], probe_[1]};
  }

  std::unique_ptr<Device> device_, prober_;
  const DeviceScene& scene_;
  DeviceOptions options_;
  int probe_[2] = {SOURCE_UNKNOWN, 0};
};

}  // namespace

std::unique_ptr<Device> with_sources(std::unique_ptr<Device> device, const DeviceScene& scene,
                                     const DeviceOptions& options) {
  return std::make_unique<DeviceWithStages>(std::move(device), scene, options);
}

}  // namespace penumbra
