#include "scheduler/run/loaded_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <iterator>
#include <optional>

#include "kernels/host/console.h"
#include "kernels/host/parallel.h"
#include "kernels/host/process.h"
#include "scenes/device/hierarchy/hierarchy_cache.h"
#include "scenes/device/media_book.h"
#include "scenes/device/scene_inventory.h"
#include "scenes/motion/scene_motion.h"
#include "scenes/names.h"
#include "scenes/scene_reader.h"
#include "scenes/setting_rows.h"
#include "scenes/settings.h"
#include "scheduler/advise/advice_text.h"
#include "scheduler/blender/blender_shots.h"
#include "scheduler/render/film_scale.h"
#include "scheduler/render/frames.h"
#include "scheduler/render/render_option.h"

namespace penumbra {
namespace {

IntersectorChoice intersector_of(const std::string& name) {
  if (name == "portable") return IntersectorChoice::kPortable;
  if (name == "embree") return IntersectorChoice::kEmbree;
  return IntersectorChoice::kAuto;
}

/// Splits name=value; the option parser has checked the form.
std::vector<std::pair<std::string, std::string>> split_assignments(
    const std::vector<std::string>& assignments) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const std::string& text : assignments) {
    const std::size_t equals = text.find('=');
    pairs.emplace_back(text.substr(0, equals), text.substr(equals + 1));
  }
  return pairs;
}

/// Adds the settings that options set. Error if a --set gives another value to one of them, because one would
/// have no effect.
Expected<void> add_settings_of_options(const SceneOptions& options, ReadOptions& read) {
  const auto set = read.settings;
  for (const RenderOption& option : all_render_options())
    for (const std::string& value : given_values(option, {.scene = options})) {
      const bool keeps_scenes = (option.sets == "sampler.type" && value == "scene") ||
                                (option.sets == "integrator.type" && value == kAutoIntegrator);
      if (option.sets.empty() || keeps_scenes) continue;
      for (const auto& [key, text] : set)
        if (to_snake_case(key) == option.sets && text != value)
          return fail(fmt::format("{} {} and --set {}={} contradict each other; give one of them",
                                  option.word(), value, key, text));
      read.settings.emplace_back(option.sets, value);
    }
  return {};
}

/// Takes Sobol points where the scene has the independent sampler and no option asks for it. Files have that
/// sampler mostly because it is the default of their formats, and its noise is larger ("Samplers" in
/// kernels/MEASUREMENTS.md). Returns whether the sampler was replaced.
bool replace_independent_sampler(const SceneOptions& options, SceneDescription& scene) {
  if (scene.sampler.kind != SamplerKind::kIndependent || options.sampler || options.needs_independent)
    return false;
  for (const auto& [key, value] : split_assignments(options.settings))
    if (to_snake_case(key) == "sampler.type") return false;
  scene.sampler.kind = SamplerKind::kSobol;
  return true;
}

/// The cache of hierarchies, unless it is not this user's alone. That is said once.
std::filesystem::path own_hierarchy_cache() {
  std::filesystem::path folder = default_hierarchy_cache();
  const auto checked = check_cache_folder(folder);
  if (checked) return folder;
  static std::atomic_flag is_said;
  if (!is_said.test_and_set()) print_warning(checked.error().message);
  return {};
}

Expected<ReadOptions> read_options_of(const SceneOptions& options) {
  ReadOptions read;
  read.defines = split_assignments(options.defines);
  read.settings = split_assignments(options.settings);
  read.lenient = options.lenient;
  read.strict = options.strict;
  read.dialect = options.dialect;
  read.clip = options.clip;
  read.fps = options.fps;
  read.export_scene = [&options](const std::filesystem::path&) { return blender_shots().scene_of(options); };
  for (const char* name : {"scene", "camera", "view-layer"})
    for (const std::string& value : given_values(*find_render_option(name), {.scene = options}))
      if (read.export_options.empty()) read.export_options = fmt::format("--{} {}", name, value);
  if (options.frame) {
    read.time = frame_seconds(options);
    read.variables = {{"frame", fmt::to_string(*options.frame)}, {"time", fmt::to_string(*read.time)}};
  }
  if (auto added = add_settings_of_options(options, read); !added) return std::unexpected(added.error());
  return read;
}

}  // namespace

Expected<void> go_to_frame(SceneDescription& scene, const SceneOptions& options) {
  if (!options.frame) return {};
  const auto read = read_options_of(options);
  if (!read) return std::unexpected(read.error());
  return set_time(scene, frame_seconds(options), *read);
}

namespace {

/// Options that a reader does not apply.
Expected<void> apply_other_options(SceneDescription& scene, const SceneOptions& options) {
  scene.sampler.seed += frame_in_seed(options);
  if (options.blends_frames && is_denoised(scene.film)) {
    std::vector<AskedLayer>& layers = scene.film.layers;
    if (std::ranges::find(layers, AskedLayer::kMotion) == layers.end()) layers.push_back(AskedLayer::kMotion);
    std::ranges::sort(layers);
  }
  if (options.frame && !options.frame_is_a_file && scene.motion == nullptr && !scene.uses_variables)
    scene.warnings.push_back(
        fmt::format("{}: warning: nothing moves in the scene, and its file has neither $frame nor $time: all "
                    "frames are alike",
                    options.file));
  if (!options.scale) return {};
  scene.film = scaled_film(scene.film, *options.scale);
  const Film& film = scene.film;
  if (std::max(film.width, film.height) > kMaxFilmSide)
    return fail(fmt::format("--scale: {} x {} pixels are more than {} a side", film.width, film.height,
                            kMaxFilmSide));
  if (auto checked = check_settings(scene); !checked) return fail("--scale: " + checked.error().message);
  return {};
}

}  // namespace

Expected<SceneDescription> read_scene_with_options(const SceneOptions& options) {
  const auto read = read_options_of(options);
  if (!read) return std::unexpected(read.error());
  auto scene = read_scene(options.file, *read);
  if (!scene) return scene;
  if (auto applied = apply_other_options(*scene, options); !applied) return std::unexpected(applied.error());
  return scene;
}

Expected<Advice> advise(ReadScene& scene, const SceneOptions& options) {
  AdviceOptions advice{.intersector = intersector_of(options.intersector),
                       .hierarchy_cache = own_hierarchy_cache(),
                       .fixed = {},
                       .takes_photons = !options.excludes_photons,
                       .threads = int(core_count())};
  for (const auto& [key, value] : split_assignments(options.settings))
    advice.fixed.push_back(to_snake_case(key));
  if (options.sampler || options.needs_independent) advice.fixed.emplace_back("sampler.type");
  return advise(scene.description, advice);
}

namespace {

/// Chooses what the options leave open.
Expected<void> make_choices(ReadScene& scene, const SceneOptions& options) {
  scene.sampler_replaced = replace_independent_sampler(options, scene.description);
  scene.choice.clear();
  scene.chosen.clear();
  if (options.integrator != kAutoIntegrator) return {};
  // All frames of a shot are rendered alike.
  const bool is_elsewhere = options.shot_begin && options.shot_begin != options.frame &&
                            !options.frame_is_a_file && !scene.description.uses_variables;
  SceneOptions at_begin = options;
  if (is_elsewhere) at_begin.frame = options.shot_begin;
  if (auto moved = is_elsewhere ? go_to_frame(scene.description, at_begin) : Expected<void>(); !moved)
    return moved;
  const auto advice = advise(scene, options);
  if (auto moved = is_elsewhere ? go_to_frame(scene.description, options) : Expected<void>(); !moved)
    return moved;
  if (!advice) return fail(fmt::format("{}: --integrator auto: {}", options.file, advice.error().message));
  scene.chosen = advice->choice().settings;
  auto settings = settings_with(scene.description, scene.chosen);
  if (!settings) return std::unexpected(settings.error());
  static_cast<RenderSettings&>(scene.description) = std::move(*settings);
  scene.choice = choice_line(*advice);
  for (const auto& [key, value] : scene.chosen) scene.sampler_replaced &= key != "sampler.type";
  return {};
}

}  // namespace

Expected<ReadScene> read_scene_to_render(const SceneOptions& options) {
  auto description = read_scene_with_options(options);
  if (!description) return std::unexpected(description.error());
  ReadScene scene{std::move(*description)};
  if (auto chosen = make_choices(scene, options); !chosen) return std::unexpected(chosen.error());
  return scene;
}

Expected<ReadScene> read_scene_file(const SceneOptions& options) {
  const auto read = read_options_of(options);
  if (!read) return std::unexpected(read.error());
  auto description = read_scene_file(options.file, *read);
  if (!description) return std::unexpected(description.error());
  return ReadScene{std::move(*description)};
}

Expected<void> complete_scene(ReadScene& scene, const SceneOptions& options) {
  const auto read = read_options_of(options);
  if (!read) return std::unexpected(read.error());
  auto done = complete_scene(scene.description, *read);
  if (done) done = apply_other_options(scene.description, options);
  if (done) done = make_choices(scene, options);
  return done;
}

namespace {

void add_device_warnings(LoadedScene& scene) {
  std::ranges::move(scene.device_warnings, std::back_inserter(scene.description.warnings));
  scene.device_warnings.clear();
}

}  // namespace

Expected<LoadedScene> load_scene(const SceneOptions& options,
                                 const std::function<void(SceneDescription&)>& adjust) {
  const auto begin = std::chrono::steady_clock::now();
  auto read = read_scene_to_render(options);
  if (!read) return std::unexpected(read.error());
  if (adjust) adjust(read->description);
  auto scene = build_scene(*read, options);
  if (!scene) return scene;
  scene->description = std::move(read->description);
  add_device_warnings(*scene);
  scene->seconds = seconds_since(begin);
  return scene;
}

Expected<LoadedScene> build_scene(const ReadScene& read, const SceneOptions& options,
                                  std::shared_ptr<const KeptFrame> kept) {
  DeviceSceneOptions device_options;
  device_options.intersector = intersector_of(options.intersector);
  device_options.feature_layers = !options.no_features;
  device_options.hierarchy_cache = own_hierarchy_cache();
  if (kept != nullptr) device_options.earlier = &kept->scene;
  MatteNames mattes;
  if (options.cryptomatte) device_options.mattes = &mattes;
  std::vector<std::string> warnings;
  device_options.warnings = &warnings;
  auto device = build_device_scene(read.description, device_options);
  if (!device) return std::unexpected(device.error());
  LoadedScene scene{{}, std::move(*device), {}, std::move(mattes), {}, 0, {}};
  scene.device_warnings = std::move(warnings);
  scene.boundary_names = boundary_names(read.description);
  scene.summary = summarize(scene.device);
  scene.sampler_replaced = read.sampler_replaced;
  scene.choice = read.choice;
  scene.chosen = read.chosen;
  scene.kept = std::move(kept);
  return scene;
}

Expected<LoadedScene> load_reduced_scene(const SceneOptions& options,
                                         const std::function<void(SceneDescription&)>& adjust) {
  auto scene = load_scene(options, adjust);
  if (scene) reduce(*scene);
  return scene;
}

void reduce(LoadedScene& scene) { reduce(scene, scene.description); }

void reduce(LoadedScene& scene, const SceneDescription& description) {
  scene.center = scene_center(description);
  const std::optional<double> fps = description.fps;  // `description` may be the scene's own
  scene.description = polygon_lights_of(description);
  scene.description.fps = fps;
  scene.description.motion.reset();
  add_device_warnings(scene);
}

}  // namespace penumbra
