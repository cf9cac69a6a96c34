#include "scheduler/run/shared_scenes.h"

#include <chrono>
#include <utility>

#include "kernels/host/process.h"
#include "scenes/instances.h"
#include "scenes/motion/scene_motion.h"
#include "scenes/settings.h"
#include "scheduler/blender/blender_shots.h"

namespace penumbra {
namespace {

/// Everything on which the scene depends: all options except the values of --spp and --seed.
SceneOptions key_of(SceneOptions options) {
  for (std::optional<std::uint32_t>* number : {&options.spp, &options.seed})
    if (*number) *number = 0;
  return options;
}

/// The same for all frames of a shot.
SceneOptions shot_of(const SceneOptions& options) {
  SceneOptions key = key_of(options);
  key.frame.reset();
  return key;
}

/// The size of the scene's large parts.
std::uint64_t bytes_of_scene(const LoadedScene& scene) {
  std::uint64_t bytes = scene.device.words.size() * sizeof(std::uint32_t);
  for (const auto* names : {&scene.mattes.objects, &scene.mattes.materials})
    for (const std::string& name : *names) bytes += sizeof name + name.size();
  return bytes + scene.mattes.mattes.size() * sizeof(MatteNames::Matte);
}

/// Sets the number of samples and the seed of a shared description according to the options. `seed`: the
/// scene's own, without the frame.
Expected<void> take_samples(SceneDescription& scene, const SceneOptions& options, std::uint32_t seed) {
  SamplerSettings& sampler = scene.sampler;
  if (options.spp) sampler.spp = *options.spp;
  sampler.seed = options.seed.value_or(seed) + frame_in_seed(options);
  return check_settings(scene);
}

/// The same of a shared scene.
Expected<void> take_samples(LoadedScene& scene, const SceneOptions& options) {
  const SamplerSettings& sampler = scene.description.sampler;
  if (auto taken = take_samples(scene.description, options, sampler.seed - frame_in_seed(options)); !taken)
    return taken;
  scene.device.header.sampler.spp = sampler.spp;
  scene.device.header.sampler.seed = sampler.seed;
  return {};
}

}  // namespace

SharedScenes::SharedScenes(const std::vector<const SceneOptions*>& renders, std::uint64_t most_bytes)
    : most_bytes_(most_bytes) {
  for (const SceneOptions* each : renders) {
    const bool is_first = ++scenes_[key_of(*each)].renders_to_come == 1;
    if (is_first && SceneFile::is_shareable(*each)) ++files_[SceneFile::reading_of(*each)].scenes_to_come;
    if (each->frame) ++shots_[shot_of(*each)].renders_to_come;
  }
  blender_shots().expect(renders);
}

void SharedScenes::keep(const SceneOptions& options, Shot& shot, ReadScene scene) {
  kept_bytes_ += shot.bytes = bytes_of(scene.description);
  shot.seed = scene.description.sampler.seed - frame_in_seed(options);
  shot.scene = std::move(scene);
}

void SharedScenes::forget(Shot& shot) {
  kept_bytes_ -= std::exchange(shot.bytes, 0);
  shot.scene.reset();
  shot.frame.reset();
}

Expected<LoadedScene> SharedScenes::load_frame(const SceneOptions& options, Shot& shot) {
  const auto begin = std::chrono::steady_clock::now();
  if (!shot.scene) {
    ++reads_;
    auto read = read_scene_to_render(options);
    if (!read) return std::unexpected(read.error());
    const bool is_kept = !read->description.uses_variables && shot.renders_to_come > 0 &&
                         bytes_of(read->description) <= most_bytes_ - kept_bytes_;
    if (!is_kept) {
      auto loaded = build_scene(*read, options);
      if (loaded) reduce(*loaded, read->description);
      if (loaded) loaded->seconds = seconds_since(begin);
      return loaded;
    }
    keep(options, shot, std::move(*read));
  }
  ReadScene& scene = *shot.scene;
  if (auto moved = go_to_frame(scene.description, options); !moved) return std::unexpected(moved.error());
  if (auto taken = take_samples(scene.description, options, shot.seed); !taken)
    return std::unexpected(taken.error());
  auto loaded = build_scene(scene, options, shot.frame);
  if (!loaded) return loaded;
  reduce(*loaded, scene.description);
  const std::uint64_t bytes = loaded->device.words.size() * sizeof(std::uint32_t);
  if (shot.frame == nullptr && shot.renders_to_come > 0 && bytes <= most_bytes_ - kept_bytes_) {
    kept_bytes_ += bytes;
    shot.bytes += bytes;
    shot.frame = std::make_shared<const KeptFrame>(KeptFrame{loaded->device, manifest_of(loaded->device)});
    loaded->kept = shot.frame;
  }
  loaded->seconds = seconds_since(begin);
  return loaded;
}

Expected<LoadedScene> SharedScenes::load_from(File& file, const SceneOptions& options) {
  if (!file.content) {
    ++reads_;
    if (file.scenes_to_come > 0)
      if (auto content = SceneFile::read(options)) file.content.emplace(std::move(*content));
    if (!file.content) return load_reduced_scene(options);
  }
  auto loaded = file.content->load(options);
  kept_bytes_ -= std::exchange(file.bytes, file.content->bytes());
  kept_bytes_ += file.bytes;
  if (file.scenes_to_come <= 0 || kept_bytes_ > most_bytes_) {
    kept_bytes_ -= std::exchange(file.bytes, 0);
    file.content.reset();
  }
  return loaded;
}

Expected<LoadedScene> SharedScenes::load(const SceneOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Scene& scene = scenes_[key_of(options)];
  const bool is_last = --scene.renders_to_come <= 0;
  Shot* shot = options.frame ? &shots_[shot_of(options)] : nullptr;
  if (shot != nullptr) --shot->renders_to_come;
  if (!scene.loaded) {
    File& file = files_[SceneFile::reading_of(options)];
    if (!std::exchange(scene.was_loaded, true)) --file.scenes_to_come;
    auto loaded = shot != nullptr ? load_frame(options, *shot) : load_from(file, options);
    if (shot != nullptr && shot->renders_to_come <= 0) forget(*shot);
    if (!loaded) return loaded;
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
