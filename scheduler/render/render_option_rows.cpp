#include "scheduler/render/render_option.h"

#include "scenes/diagnostic.h"
#include "scenes/settings.h"
#include "scheduler/render/film_scale.h"
#include "scheduler/render/frames.h"
#include "scheduler/render/option_checks.h"
#include "scheduler/render/stored_option.h"
#include "worker/cli/help_text.h"
#include "worker/work_unit.h"

namespace penumbra {
namespace {

#define AT PENUMBRA_AT

/// Makes it an option that sets a setting. `none`: the setting's value without which a render is the same.
void sets(RenderOption& option, const std::string& key, const std::string& none = "") {
  option.sets = key;
  option.setting = [key, none](const RenderSettings& settings) {
    const std::string text = print_setting(settings, key);
    return text == none ? Texts() : Texts{text};
  };
}

OptionCheck choice_of(std::string_view key) { return one_of(find_setting(key)->choices); }

Texts crop_of(const RenderSettings& settings) {
  const Film& film = settings.film;
  const bool is_whole = film.crop_x == 0 && film.crop_y == 0 && film.crop_width == film.width &&
                        film.crop_height == film.height;
  return is_whole ? Texts()
                  : texts_of(CropRectangle{film.crop_x, film.crop_y, film.crop_x + film.crop_width,
                                           film.crop_y + film.crop_height});
}

Expected<void> apply_scale(RenderRequest& request, std::string& text) {
  const auto scale = parse_scale(text);
  if (!scale) return std::unexpected(scale.error());
  request.scene.scale = *scale == 1 ? std::nullopt : std::optional(*scale);
  return {};
}

std::string wrong_layers(const std::string& text) {
  RenderSettings settings;
  const auto applied = apply_setting(settings, "film.layers", text);
  return applied ? std::string() : applied.error().message;
}

using enum OptionPart;
using enum OptionEffect;

Expected<void> apply_seed_per_frame(RenderRequest& request, std::string& text) {
  if (const std::string wrong = one_of({"fixed", "frame"}).wrong(text); !wrong.empty()) return fail(wrong);
  request.scene.seed_by_frame = text == "frame";
  return {};
}

void add_frame_rows(std::vector<RenderOption>& all) {
  OptionRows frames{all, group::kFrames, kScene, kPixels};
  frames.add("--frame", "N", AT(scene.frame), {whole_number(0, kLastFrame)},
             "One frame of a scene that moves: shows it at N / fps seconds, as $frame and $time of its file");
  frames.add("--fps", "RATE", AT(scene.fps), {positive_number()}, "Frames per second (default: 24)");
  frames.add("--frame-offset", "N", AT(scene.frame_offset), {}, "Add N to the frame before its time is taken")
      .matters = [](const RenderRequest& request) { return request.scene.frame_offset != 0; };
  frames.add(
      "--clip", "NAME", AT(scene.clip), {},
      "Animation of a glTF file (default: the first, and those that change other things; `penumbra info` "
      "lists them)");
  RenderOption& seed = frames.add("--seed-per-frame", "MODE", AT(scene.seed_by_frame), {},
                                  "fixed: all frames have the same seed; frame: the frame is added to it");
  seed.kind = OptionKind::kText;
  seed.effect = kNone;  // the seed that it leads to is kept
  seed.limits = "fixed, frame";
  seed.apply = apply_seed_per_frame;
  seed.print = [](const RenderRequest& request) {
    return Texts{request.scene.seed_by_frame ? "frame" : "fixed"};
  };
  seed.shows_default = true;
}

void add_scene_rows(std::vector<RenderOption>& all) {
  OptionRows input{all, group::kInput, kScene, kPixels};
  input
      .add("-D", "NAME=VALUE", AT(scene.defines), {assignment()},
           "Fill $NAME of the scene file, as in -D albedo=0.5; repeatable")
      .recorded_as = "defines";
  input.add(
      "--set", "KEY=VALUE", AT(scene.settings), {assignment()},
      "Override a parameter of integrator, sampler, film or camera, as in --set integrator.max_depth=3; "
      "repeatable; `penumbra settings` lists them");
  OptionRows{all, group::kRegion, kScene, kPixels}
      .add("--scale", "PERCENT", AT(scene.scale), {},
           "Film of so much of its width and height, with its crop window, as in 25% or 0.25; rounded to the "
           "nearest pixel, at least 1")
      .apply = apply_scale;
  input.effect = kFiles;
  input.add("--lenient", "", AT(scene.lenient), {},
            "Warn of what is unknown, missing or out of range, and render the rest");
  input.add("--strict", "", AT(scene.strict), {}, "Take every warning about the scene for an error").effect =
      kNone;
  input.add("--dialect", "NAME", AT(scene.dialect), {one_of({"nori", "nori-eth"})},
            "Of Nori scenes: nori-eth is that of ETH Zurich's course, whose camera is mirrored (default: "
            "told from the file; `penumbra info` shows it)");
  input.effect = kPixels;
  input.add("--blender-scene,--scene", "NAME", AT(scene.blender_scene), {},
            "Scene of a .blend file (default: the one that is open in it)");
  input.add("--camera", "NAME", AT(scene.camera), {}, "Camera of a .blend file (default: the scene's)");
  input.add("--view-layer", "NAME", AT(scene.view_layer), {},
            "View layer of a .blend file (default: the scene's first)");
  input
      .add("--blender", "PROGRAM", AT(scene.blender), {},
           "Blender 4.2 or newer, or a Python that has bpy, to export .blend files (default: "
           "PENUMBRA_BLENDER, `blender` in PATH, PENUMBRA_BLENDER_PYTHON)")
      .effect = kNone;
  add_frame_rows(all);
  OptionRows sampling{all, group::kSampling, kScene, kFiles};
  sets(sampling.add("--integrator", "NAME", AT(scene.integrator), {one_of(integrator_choices())},
                    "Integrator instead of the scene's; path is path_mis; auto: by pilot renders"),
       "integrator.type");
  sets(sampling.add(
           "--sampler", "NAME", AT(scene.sampler), {one_of(sampler_names())},
           "Sampler. scene: the scene's; without this option, sobol replaces the scene's independent"),
       "sampler.type");
  sets(sampling.add("--spp", "N", AT(scene.spp), {whole_number(1, kMaxSamplesPerPixel)},
                    "Samples per pixel (default: the scene's)"),
       "sampler.sample_count");
  sets(sampling.add("--seed", "S", AT(scene.seed), {whole_number(0, kMaxSeed)},
                    "Seed of all random numbers (default: the scene's, or 0)"),
       "sampler.seed");
}

void add_plan_rows(std::vector<RenderOption>& all) {
  OptionRows plan{all, group::kSampling, kRender, kPixels};
  plan.add("--time-budget", "SECONDS", AT(time_budget), {seconds(), positive_number()},
           "Start no tile after this time of rendering, as in 90, 15m or 8h; the first pass is always "
           "rendered")
      .effect = kNone;
  plan.add("--stop-after", "N", AT(plan.stop_after), {whole_number(1, kMaxSamplesPerPixel)},
           "Render only the first N of --spp samples")
      .excludes = {"adaptive"};
  plan.add("--pass", "N", AT(plan.samples_per_pass), {whole_number(1, kMaxSamplesPerUnit)},
           "Samples per pixel of a pass (default: 16); the image's last bits depend on it. With ppm "
           "they share a photon map (default: 1)")
      .recorded_as = "samples_per_pass";
  RenderOption& target =
      plan.add("--target-error", "E", AT(plan.target_error), {positive_number()},
               "Sample each tile until its relative error is at most this (0.02 is 2%), or --spp is "
               "reached. Without bias; takes --sampler independent; the image depends on --tile. With "
               "photon mapping the error is that of noise alone, not of bias");
  target.recorded_as_text = true;  // as ever
  target.apply = [set = target.apply](RenderRequest& request, std::string& text) {
    request.scene.needs_independent = true;
    return set(request, text);
  };
  RenderOption& adaptive =
      plan.add("--adaptive", "", AT(plan.adaptive), {},
               "Give noisy tiles more samples, by the error of two pilot samples per pixel; --spp is the "
               "mean. Without bias; the image depends on --tile. Not with photon mapping");
  adaptive.excludes = {"target-error", "pixel"};
  adaptive.apply = [set = adaptive.apply](RenderRequest& request, std::string& text) {
    const auto done = set(request, text);
    request.scene.excludes_photons = request.plan.adaptive;
    return done;
  };
  plan.add("--stop-after-units", "N", AT(plan.stop_after_units), {whole_number(1, std::int64_t(1) << 62)},
           "Render only the first N work units, pass by pass and tile by tile: repeats what a time "
           "budget ended")
      .excludes = {"stop-after", "target-error", "adaptive"};
}

void add_device_rows(std::vector<RenderOption>& all) {
  OptionRows device{all, group::kWorkers, kDevice, kNone};
  device
      .add("--threads", "N", AT(threads), {whole_number(1, kMaxThreads)},
           "Threads of each worker (default: cores / workers)")
      .recorded_as = "threads_per_worker";
  OptionRows{all, group::kWorkers, kRender, kPixels}
      .add("--tile", "N", AT(plan.tile), {whole_number(1, kMaxTile)},
           "Side of a tile in pixels (default: 64; 256 with ppm). The image depends on it only with "
           "--target-error and --adaptive")
      .matters = [](const RenderRequest& request) { return request.plan.depends_on_tiles(); };
  OptionRows{all, group::kSampling, kScene, kPixels}
      .add("--intersector", "NAME", AT(scene.intersector), {one_of({"auto", "portable", "embree"})},
           "portable: the same bits on every machine; embree: faster in large scenes; auto: by the "
           "size of the scene. Large hierarchies are cached in ~/.cache/penumbra/hierarchies, or in "
           "PENUMBRA_HIERARCHY_CACHE=FOLDER; off: not")
      .shows_default = true;
  device.effect = kPixels;
  device
      .add("--isa", "NAME", AT(isa), {one_of({"sse2", "avx2", "avx512"})},
           "Instruction set of the native backend (default: the widest of the machine)")
      .matters = [](const RenderRequest& request) { return request.scene.intersector == "embree"; };
  device
      .add("--backend", "NAME", AT(backend), {one_of({"native", "opencl", "auto"})},
           "What renders; auto: OpenCL where a device other than a CPU renders the same bits, else "
           "native. Compiled kernels are cached in ~/.cache/penumbra/kernels, or in "
           "PENUMBRA_KERNEL_CACHE=FOLDER; off: not")
      .shows_default = true;
  device.effect = kNone;
  device.add("--opencl-device,--device", "NAME", AT(opencl_device), {},
             "OpenCL device: its number, or part of its name or its platform's (default: the first CPU, "
             "else the first device); `penumbra worker --list-devices` lists them");
  OptionRows{all, group::kWorkers, kRender, kNone}
      .add("--verify", "SHARE", AT(verify), {number_between(0, 1)},
           "Share of the work units that a second worker renders too (0.05 is 5%). Where results "
           "differ both workers are dismissed and their work is done again. Needs two workers")
      .shows_default = true;
}

void add_output_rows(std::vector<RenderOption>& all) {
  OptionRows output{all, group::kOutput, kRender, kNone};
  output
      .add("-o,--out", "FILE", AT(out), {},
           "x.exr writes x.exr and x.png, x.png only that, a folder the scene's name in it (default: "
           "the scene's name with .exr, in the current folder). For several scenes a folder, or a "
           "name with fields: {scene}, {folder}, {seed:03} and other options of a render")
      .scope = OptionScope::kOneRender;
  output
      .add("--statistics,--report", "FILE", AT(statistics), {},
           "JSON of settings, rates, times, memory and workers (default: beside the image, .json)")
      .scope = OptionScope::kOneRender;
  output.add("--no-statistics,--no-report", "", AT(no_statistics), {}, "Write no statistics").excludes = {
      "statistics"};
  output.effect = kFiles;
  output.add("--no-features", "", AT(scene.no_features), {}, "Leave out the albedo, normal and depth layers")
      .part = kScene;
  output.add("--cryptomatte", "", AT(scene.cryptomatte), {},
             "Add object and material IDs to the EXR (Cryptomatte), by the scene's names");
  sets(output.add(
           "--denoise{nfor}", "METHOD", AT(scene.denoise), {choice_of("film.denoise")},
           "Write a denoised image too, NAME-denoised.exr and .png; =nlmeans and =oidn are other methods, "
           "=layers adds only the layers for `penumbra denoise`"),
       "film.denoise", "off");
  sets(output.add(
           "--layers", "NAMES", AT(scene.layers), {{wrong_layers}},
           "Add layers to the EXR, separated by commas: " + list_names(find_setting("film.layers")->choices) +
               "; none: not those that the scene asks for"),
       "film.layers", "none");
  OptionRows region{all, group::kRegion, kRender, kFiles};
  region
      .add("--crop", "X0,Y0,X1,Y1", AT(crop), {},
           "Render only these pixels of the film, after --scale, without column x1 and row y1; they are the "
           "same as in the whole image")
      .setting = crop_of;
  RenderOption& pixel =
      region.add("--pixel", "X,Y", AT(pixel), {},
                 "Render one pixel and print all its digits; files are written only with -o");
  pixel.effect = kNone;
  pixel.scope = OptionScope::kOneRender;
  pixel.excludes = {"crop"};
  output.effect = kNone;
  output.add("--strict-numerics", "", AT(strict_numerics), {},
             "Exit code 1 where samples are NaN or infinite, or media contradict each other, instead of a "
             "warning; files are written");
}

}  // namespace

std::span<const RenderOption> all_render_options() {
  static const std::vector<RenderOption> rows = [] {
    std::vector<RenderOption> all;
    add_scene_rows(all);
    add_plan_rows(all);
    add_device_rows(all);
    add_output_rows(all);
    return all;
  }();
  return rows;
}

std::vector<std::string> integrator_choices() {
  std::vector<std::string> names = find_setting("integrator.type")->choices;
  names.insert(names.begin(), kAutoIntegrator);
  return names;
}

std::vector<std::string> sampler_names() {
  std::vector<std::string> names = find_setting("sampler.type")->choices;
  names.emplace_back("scene");
  return names;
}

}  // namespace penumbra
