#include "tests/support/fake_device.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <thread>

#include "kernels/features.h"
#include "scenes/bsdfs/material.h"
#include "tests/support/fake_samples.h"

namespace penumbra {
namespace {

/// Calls visit(variable, field) for every field.
template <typename Behaviour, typename Visit>
void for_each_field(Behaviour& behaviour, Visit visit) {
  visit("PENUMBRA_FAKE_DELAY_MS", behaviour.delay_ms);
  visit("PENUMBRA_FAKE_CRASH_AT", behaviour.crash_at);
  visit("PENUMBRA_FAKE_FAIL_AT", behaviour.fail_at);
  visit("PENUMBRA_FAKE_HANG_CLAIM", behaviour.hang_claim);
  visit("PENUMBRA_FAKE_LIE_CLAIM", behaviour.lie_claim);
  visit("PENUMBRA_FAKE_LIAR_DELAY_MS", behaviour.liar_delay_ms);
  visit("PENUMBRA_FAKE_DAMAGE_CLAIM", behaviour.damage_claim);
  visit("PENUMBRA_FAKE_NAN_CLAIM", behaviour.nan_claim);
  visit("PENUMBRA_FAKE_DIE_AT_START", behaviour.die_at_start);
  visit("PENUMBRA_FAKE_VANISH_CLAIM", behaviour.vanish_claim);
  visit("PENUMBRA_FAKE_DEADLY_SCENE", behaviour.deadly_scene);
  visit("PENUMBRA_FAKE_PREPARE_MS", behaviour.prepare_ms);
  visit("PENUMBRA_FAKE_NO_DEVICE", behaviour.no_device);
  visit("PENUMBRA_FAKE_FAIL_ALWAYS", behaviour.fail_always);
  visit("PENUMBRA_FAKE_ISAS", behaviour.isas);
}

constexpr int kPartMs = 100;

bool claim(const std::string& file) {
  if (file.empty()) return false;
  const int descriptor = open(file.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0600);
  if (descriptor < 0) return false;
  close(descriptor);
  return true;
}

class FakeDevice final : public Device {
 public:
  FakeDevice(const DeviceScene& scene, FakeBehaviour behaviour)
      : scene_(scene),
        behaviour_(std::move(behaviour)),
        shift_(scene.header.camera.origin.x),
        layers_(scene.header.features),
        hangs_(claim(behaviour_.hang_claim)),
        lies_(claim(behaviour_.lie_claim)),
        damages_(claim(behaviour_.damage_claim)),
        spoils_(claim(behaviour_.nan_claim)) {}

  [[nodiscard]] std::string description() const override { return "fake"; }

  Expected<SampleBuffer> render(const RenderUnit& unit) override {
    const std::string place = fmt::format("{},{},{}", unit.x, unit.y, unit.first_sample);
    if (lies_ && units_ == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(behaviour_.liar_delay_ms));
    // As a device that gets on.
    for (int left = behaviour_.delay_ms; left > 0; left -= kPartMs, part_is_done())
      std::this_thread::sleep_for(std::chrono::milliseconds(std::min(left, kPartMs)));
    if (place == behaviour_.crash_at) kill(getpid(), SIGKILL);
    if (place == behaviour_.fail_at || behaviour_.fail_always != 0)
      return fail("the fake device was told to fail");
    ++units_;
    while (hangs_ && units_ == 2) pause();
    SampleBuffer buffer = fake_samples(unit, layers_, shift_);
    if (lies_) buffer.values[unit.sample_count % buffer.values.size()] += 0.25f;
    if (spoils_) buffer.values[buffer.values.size() / 2] = std::numeric_limits<float>::quiet_NaN();
    if (damages_) buffer.values.pop_back();
    return buffer;
  }

  Expected<void> take_view() override {
    shift_ = scene_.header.camera.origin.x;
    return {};
  }

 private:
  const DeviceScene& scene_;
  FakeBehaviour behaviour_;
  float shift_;
  FilmLayers layers_;
  bool hangs_, lies_, damages_, spoils_;
  int units_ = 0;
};

}  // namespace

DeviceScene fake_scene(int film_width, int film_height, bool features) {
  DeviceScene scene;
  scene.header.integrator.kind = INTEGRATOR_PATH;
  scene.header.sampler.kind = SAMPLER_SOBOL;
  scene.header.features = FEATURE_PATH | (features ? FEATURE_LAYERS : 0);
  scene.header.intersector = INTERSECTOR_EMBREE;  // needs no search structure in the data
  scene.header.film.width = film_width;
  scene.header.film.height = film_height;
  scene.header.sampler.spp = 1;
  scene.header.environment = -1;
  scene.words.resize(1024);  // one record of every table, all zero, and the black material
  scene.header.tables.materials = {1, 512};
  const Material black = material_of_family(FAMILY_BLACK);
  std::memcpy(scene.words.data() + 512, &black, sizeof black);
  return scene;
}

void FakeBehaviour::to_environment() const {
  for_each_field(*this, [](const char* variable, const auto& value) {
    setenv(variable, fmt::format("{}", value).c_str(), 1);
  });
}

FakeBehaviour FakeBehaviour::from_environment() {
  FakeBehaviour behaviour;
  for_each_field(behaviour, [](const char* variable, auto& value) {
    const char* text = std::getenv(variable);
    if (text == nullptr) return;
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, int>) {
      value = std::atoi(text);
    } else {
      value = text;
    }
  });
  return behaviour;
}

Expected<std::unique_ptr<Device>> make_fake_device(const DeviceScene& scene, const DeviceOptions&,
                                                   const FakeBehaviour& behaviour) {
  if (behaviour.deadly_scene != 0 && float(behaviour.deadly_scene) == scene.header.camera.origin.x)
    kill(getpid(), SIGKILL);
  for (const char* number : {"1", "2", "3"}) {
    if (behaviour.vanish_claim.empty() || !claim(behaviour.vanish_claim + number)) continue;
    // No thread is left that would end the process, which keeps its number.
    execlp("sleep", "sleep", "1000", nullptr);
    _exit(127);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(behaviour.prepare_ms));
  if (behaviour.no_device != 0) return fail("there is no fake device today");
  return std::make_unique<FakeDevice>(scene, behaviour);
}

}  // namespace penumbra
