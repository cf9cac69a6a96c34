#include "scheduler/cli/sets/shared_scenes.h"

#include <chrono>
#include <utility>

#include "kernels/host/process.h"
#include "scenes/settings.h"

namespace penumbra {
namespace {

/// Everything on which the scene depends: all options except the values of --spp and --seed.
SceneOptions key_of(SceneOptions options) {
  for (std::optional<std::uint32_t>* number : {&options.spp, &options.seed})
    if (*number) *number = 0;
  return options;
}

/// The size of the scene's large parts.
std::uint64_t bytes_of_scene(const LoadedScene& scene) {
  std::uint64_t bytes = scene.device.words.size() * sizeof(std::uint32_t);
  for (const auto* names : {&scene.mattes.objects, &scene.mattes.materials})
    for (const std::string& name : *names) bytes += sizeof name + name.size();
  return bytes + scene.mattes.mattes.size() * sizeof(MatteNames::Matte);
}

/// Sets the number of samples and the seed of the shared scene according to the options.
Expected<void> take_samples(LoadedScene& scene, const SceneOptions& options) {
  SamplerSettings& sampler = scene.description.sampler;
  if (options.spp) sampler.spp = *options.spp;
  if (options.seed) sampler.seed = *options.seed;
  if (auto checked = check_settings(scene.description); !checked) return checked;
  scene.device.header.sampler.spp = sampler.spp;
  scene.device.header.sampler.seed = sampler.seed;
  return {};
}

}  // namespace

SharedScenes::SharedScenes(const std::vector<const SceneOptions*>& renders, std::uint64_t most_bytes)
    : most_bytes_(most_bytes) {
  for (const SceneOptions* each : renders) ++scenes_[key_of(*each)].renders_to_come;
}

Expected<LoadedScene> SharedScenes::load(const SceneOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Scene& scene = scenes_[key_of(options)];
  const bool is_last = --scene.renders_to_come <= 0;
  if (!scene.loaded) {
    ++reads_;
    auto loaded = load_scene(options);
    if (!loaded) return loaded;
    reduce(*loaded);
    const std::uint64_t bytes = bytes_of_scene(*loaded);
    if (!is_last && bytes <= most_bytes_ - kept_bytes_) {
      scene.loaded = *loaded;
      kept_bytes_ += scene.bytes = bytes;
    }
    return loaded;
  }
  LoadedScene loaded = is_last ? std::move(*scene.loaded) : *scene.loaded;
  if (is_last) {
    scene.loaded.reset();
    kept_bytes_ -= scene.bytes;
  }
  if (auto taken = take_samples(loaded, options); !taken) return std::unexpected(taken.error());
  loaded.seconds = seconds_since(begin);
  return loaded;
}

}  // namespace penumbra
