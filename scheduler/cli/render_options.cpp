#include "scheduler/cli/render_options.h"
#include "worker/cli/access_options.h"

#include <charconv>
#include <span>

#include "kernels/host/device_scene.h"
#include "scenes/diagnostic.h"
#include "scenes/scene_reader.h"
#include "scenes/settings.h"
#include "scheduler/cli/film_scale.h"
#include "scheduler/cli/option_checks.h"
#include "scheduler/cli/option_hints.h"
#include "scheduler/cli/web_page.h"
#include "worker/cli/help_text.h"
#include "worker/device.h"
#include "worker/work_unit.h"

namespace penumbra {
namespace {

/// Parses exactly `values.size()` non-negative integers separated by commas.
bool parse_integers(const std::string& text, std::span<int> values) {
  const char* at = text.data();
  const char* end = text.data() + text.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0 && (at == end || *at++ != ',')) return false;
    const auto [next, error] = std::from_chars(at, end, values[i]);
    if (error != std::errc() || values[i] < 0) return false;
    at = next;
  }
  return at == end;
}

}  // namespace

std::optional<CropRectangle> parse_crop(const std::string& text) {
  int v[4];
  if (!parse_integers(text, v) || v[0] >= v[2] || v[1] >= v[3]) return std::nullopt;
  return CropRectangle{v[0], v[1], v[2], v[3]};
}

std::optional<PixelPosition> parse_pixel(const std::string& text) {
  int v[2];
  if (!parse_integers(text, v)) return std::nullopt;
  return PixelPosition{v[0], v[1]};
}

std::vector<std::string> sampler_names() {
  std::vector<std::string> names = find_setting("sampler.type")->choices;
  names.emplace_back("scene");
  return names;
}

PlanOptions plan_of(const RenderOptions& options, const IntegratorSettings& integrator) {
  const bool with_maps = integrator.is<ProgressivePhotonIntegrator>();
  PlanOptions plan = options.plan;
  plan.samples_per_pass = options.samples_per_pass.value_or(with_maps ? kPassWithMaps : kDefaultPass);
  plan.tile = options.tile.value_or(with_maps ? kTileWithMaps : kDefaultTile);
  return plan;
}

void add_scene_options(CommandLine& command, SceneOptions& options) {
  command.add_option("SCENE", options.scene, "Scene file: " + list_names(scene_formats()))
      ->required()
      ->group(group::kInput);
  add_scene_overrides(command, options);
}

namespace {

void add_scene_text_options(CommandLine& command, SceneOptions& options) {
  command.explain([&command](const std::string& word) { return option_hint(command, word); });
  command.add_option("-D", options.defines, "Fill $NAME of the scene file, as in -D albedo=0.5; repeatable")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false)
      ->check(assignment())
      ->group(group::kInput);
  command
      .add_option(
          "--set", options.settings,
          "Override a parameter of integrator, sampler, film or camera, as in --set integrator.max_depth=3; "
          "repeatable; `penumbra settings` lists them")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->check(assignment())
      ->group(group::kInput);
  command
      .add_flag("--lenient", options.lenient,
                "Warn of what is unknown, missing or out of range, and render the rest")
      ->group(group::kInput);
  command.add_flag("--strict", options.strict, "Take every warning about the scene for an error")
      ->group(group::kInput);
  command
      .add_option(
          "--dialect", options.dialect,
          "Of Nori scenes: nori-eth is that of ETH Zurich's course, whose camera is mirrored (default: "
          "told from the file; `penumbra info` shows it)")
      ->type_name("NAME")
      ->check(one_of({"nori", "nori-eth"}))
      ->group(group::kInput);
}

void add_sampling_options(CommandLine& command, SceneOptions& options) {
  command
      .add_option("--integrator", options.integrator, "Integrator instead of the scene's; path is path_mis")
      ->type_name("NAME")
      ->check(one_of(find_setting("integrator.type")->choices))
      ->group(group::kSampling);
  command
      .add_option("--sampler", options.sampler,
                  "Sampler. scene: the scene's; without this option, sobol replaces the scene's independent")
      ->type_name("NAME")
      ->check(one_of(sampler_names()))
      ->group(group::kSampling);
  command.add_option("--spp", options.spp, "Samples per pixel (default: the scene's)")
      ->type_name("N")
      ->check(whole_number(1, kMaxSamplesPerPixel))
      ->group(group::kSampling);
  command.add_option("--seed", options.seed, "Seed of all random numbers (default: the scene's, or 0)")
      ->type_name("S")
      ->check(whole_number(0, kMaxSeed))
      ->group(group::kSampling);
  command
      .add_option("--intersector", options.intersector,
                  "portable: the same bits on every machine; embree: faster in large scenes; auto: by the "
                  "size of the scene. Large hierarchies are cached in ~/.cache/penumbra/hierarchies, or in "
                  "PENUMBRA_HIERARCHY_CACHE=FOLDER; off: not")
      ->type_name("NAME")
      ->check(one_of({"auto", "portable", "embree"}))
      ->capture_default_str()
      ->group(group::kSampling);
}

void add_layer_options(CommandLine& command, SceneOptions& options) {
  command.add_flag("--no-features", options.no_features, "Leave out the albedo, normal and depth layers")
      ->group(group::kOutput);
}

void add_device_options(CommandLine& command, RenderOptions& options) {
  command.add_option("--threads", options.threads, "Threads of each worker (default: cores / workers)")
      ->type_name("N")
      ->check(whole_number(1, kMaxThreads))
      ->group(group::kWorkers);
  command
      .add_option("--backend", options.backend,
                  "What renders; auto: OpenCL where a device other than a CPU renders the same bits, else "
                  "native. Compiled kernels are cached in ~/.cache/penumbra/kernels, or in "
                  "PENUMBRA_KERNEL_CACHE=FOLDER; off: not")
      ->type_name("NAME")
      ->check(one_of({"native", "opencl", "auto"}))
      ->capture_default_str()
      ->group(group::kWorkers);
  command
      .add_option("--opencl-device,--device", options.opencl_device,
                  "OpenCL device: its number, or part of its name or its platform's (default: the first CPU, "
                  "else the first device); `penumbra worker --list-devices` lists them")
      ->type_name("NAME")
      ->group(group::kWorkers);
  command
      .add_option("--isa", options.isa,
                  "Instruction set of the native backend (default: the widest of the machine)")
      ->type_name("NAME")
      ->check(one_of({"sse2", "avx2", "avx512"}))
      ->group(group::kWorkers);
}

void add_scale_option(CommandLine& command, SceneOptions& options) {
  command
      .add_option_function(
          "--scale",
          [&options](const std::string& text) -> Expected<void> {
            const auto scale = parse_scale(text);
            if (!scale) return std::unexpected(scale.error());
            options.scale = *scale == 1 ? std::nullopt : std::optional(*scale);
            return {};
          },
          "Film of so much of its width and height, with its crop window, as in 25% or 0.25; rounded to the "
          "nearest pixel, at least 1")
      ->type_name("PERCENT")
      ->group(group::kRegion);
}

/// Options for workers and viewers.
void add_worker_options(CommandLine& command, RenderOptions& options) {
  Option* workers = command
                        .add_option("--workers", options.workers,
                                    "Worker processes on this machine, each with a copy of the scene")
                        ->type_name("N")
                        ->check(whole_number(1, kMaxWorkers))
                        ->capture_default_str()
                        ->group(group::kWorkers);
  command
      .add_option("--launch", options.launch,
                  "Start the workers with this command instead, as in --launch 'srun -n 32'. They connect to "
                  "--listen, or from this machine alone without it, and use all cores that they are given, "
                  "or --threads")
      ->type_name("COMMAND")
      ->excludes(workers)
      ->group(group::kWorkers);
  add_device_options(command, options);
  command
      .add_option("--tile", options.tile,
                  "Side of a tile in pixels (default: 64; 256 with ppm). The image depends on it only with "
                  "--target-error and --adaptive")
      ->type_name("N")
      ->check(whole_number(1, kMaxTile))
      ->group(group::kWorkers);
  command
      .add_option("--listen", options.listen,
                  "Another address for windows and workers: unix:/path, or 127.0.0.1:PORT (0: a free port) "
                  "with a token, which is printed. With --keys other hosts too: 0.0.0.0:PORT for all")
      ->type_name("ADDRESS")
      ->check(some_text())
      ->group(group::kNetwork);
  add_keys_option(command, options.keys, "TLS and tokens for --listen HOST:PORT")->group(group::kNetwork);
  command
      .add_option("--tev", options.tev,
                  "Show the render in a running tev while it converges; tev's own address is "
                  "127.0.0.1:14158")
      ->type_name("HOST:PORT")
      ->group(group::kNetwork);
}

void add_output_options(CommandLine& command, RenderOptions& options) {
  command
      .add_option("-o,--out", options.out,
                  "x.exr writes x.exr and x.png, x.png only that, a folder the scene's name in it (default: "
                  "the scene's name with .exr, in the current folder). For several scenes a folder, or a "
                  "name with fields: {scene}, {folder}, {seed:03} and other options of a render")
      ->type_name("FILE")
      ->group(group::kOutput);
  auto* statistics = command.add_option(
      "--statistics,--report", options.statistics,
      "JSON of settings, rates, times, memory and workers (default: beside the image, .json)");
  statistics->type_name("FILE")->group(group::kOutput);
  command.add_flag("--no-statistics,--no-report", options.no_statistics, "Write no statistics")
      ->excludes(statistics)
      ->group(group::kOutput);
  command
      .add_flag("--cryptomatte", options.scene.cryptomatte,
                "Add object and material IDs to the EXR (Cryptomatte), by the scene's names")
      ->group(group::kOutput);
  command
      .add_flag(
          "--denoise{nfor}", options.scene.denoise,
          "Write a denoised image too, NAME-denoised.exr and .png; =nlmeans and =oidn are other methods, "
          "=layers adds only the layers for `penumbra denoise`")
      ->type_name("METHOD")
      ->check(one_of(find_setting("film.denoise")->choices))
      ->group(group::kOutput);
  command
      .add_option(
          "--layers", options.scene.layers,
          "Add layers to the EXR, separated by commas: " + list_names(find_setting("film.layers")->choices) +
              "; none: not those that the scene asks for")
      ->type_name("NAMES")
      ->check({[](const std::string& text) {
        RenderSettings settings;
        const auto done = apply_setting(settings, "film.layers", text);
        return done ? std::string() : done.error().message;
      }})
      ->group(group::kOutput);
  command
      .add_flag("--strict-numerics", options.strict_numerics,
                "Exit code 1 where samples are NaN or infinite, or media contradict each other, instead of a "
                "warning; files are written")
      ->group(group::kOutput);
  command
      .add_flag("--force", options.force,
                "Of several scenes, render also those whose images are there and would be the same")
      ->group(group::kOutput);
  command
      .add_option("--summary", options.summary,
                  "Of several scenes, JSON of what became of each (default: jobs.json beside the images, or "
                  "beside the job file, for NAME.toml NAME.jobs.json)")
      ->type_name("FILE")
      ->group(group::kOutput);
  command
      .add_option("--table", options.table,
                  "Of several scenes, CSV of what became of each: its parameters, time and error")
      ->type_name("FILE")
      ->check(some_text())
      ->group(group::kOutput);
}

/// Options for the rendered region and the number of samples.
void add_region_options(CommandLine& command, RenderOptions& options) {
  auto* crop = command.add_option_function(
      "--crop",
      [&options](const std::string& text) -> Expected<void> {
        options.crop = parse_crop(text);
        if (options.crop) return {};
        return fail("'" + text + "' is not x0,y0,x1,y1 with 0 <= x0 < x1, 0 <= y0 < y1");
      },
      "Render only these pixels of the film, after --scale, without column x1 and row y1; they are the same "
      "as in the whole "
      "image");
  crop->type_name("X0,Y0,X1,Y1")->group(group::kRegion);
  auto* pixel = command.add_option_function(
      "--pixel",
      [&options](const std::string& text) -> Expected<void> {
        options.pixel = parse_pixel(text);
        if (options.pixel) return {};
        return fail("'" + text + "' is not x,y with x and y from 0 up");
      },
      "Render one pixel and print all its digits; files are written only with -o");
  pixel->type_name("X,Y")->excludes(crop)->group(group::kRegion);
}

void add_effort_options(CommandLine& command, RenderOptions& options) {
  command
      .add_option("--time-budget", options.time_budget,
                  "Start no tile after this time of rendering, as in 90, 15m or 8h; the first pass is always "
                  "rendered")
      ->type_name("SECONDS")
      ->transform(seconds())
      ->check(positive_number())
      ->group(group::kSampling);
  command
      .add_option_function(
          "--target-error",
          [&options](double error) {
            options.plan.target_error = error;
            options.scene.needs_independent = true;
            return Expected<void>();
          },
          "Sample each tile until its relative error is at most this (0.02 is 2%), or --spp is "
          "reached. Without bias; takes --sampler independent; the image depends on --tile. With "
          "photon mapping the error is that of noise alone, not of bias")
      ->type_name("E")
      ->check(positive_number())
      ->group(group::kSampling);
  command
      .add_flag("--adaptive", options.plan.adaptive,
                "Give noisy tiles more samples, by the error of two pilot samples per pixel; --spp is the "
                "mean. Without bias; the image depends on --tile. Not with photon mapping")
      ->excludes("--target-error")
      ->excludes("--pixel")
      ->group(group::kSampling);
  command
      .add_option("--pass", options.samples_per_pass,
                  "Samples per pixel of a pass (default: 16); the image's last bits depend on it. With ppm "
                  "they share a photon map (default: 1)")
      ->type_name("N")
      ->check(whole_number(1, kMaxSamplesPerUnit))
      ->group(group::kSampling);
  command.add_option("--stop-after", options.plan.stop_after, "Render only the first N of --spp samples")
      ->type_name("N")
      ->check(whole_number(1, kMaxSamplesPerPixel))
      ->excludes("--adaptive")
      ->group(group::kSampling);
  command
      .add_option("--stop-after-units", options.plan.stop_after_units,
                  "Render only the first N work units, pass by pass and tile by tile: repeats what a time "
                  "budget ended")
      ->type_name("N")
      ->check(whole_number(1, std::int64_t(1) << 62))
      ->excludes("--stop-after")
      ->excludes("--target-error")
      ->excludes("--adaptive")
      ->group(group::kSampling);
}

void add_checkpoint_options(CommandLine& command, RenderOptions& options) {
  Option* resume =
      command
          .add_flag("--resume", options.resume,
                    "Continue an interrupted run of the same render from its IMAGE.checkpoint. That is the "
                    "default; with this, say so where there is none")
          ->excludes("--pixel")
          ->group(group::kCheckpoints);
  command.add_flag("--restart", options.restart, "Begin anew, and replace what an interrupted run has left")
      ->excludes(resume)
      ->group(group::kCheckpoints);
  command
      .add_option("--checkpoint-interval", options.checkpoint_interval,
                  "Time between checkpoints, longer where they would take more than 1% of it; 0: none")
      ->type_name("SECONDS")
      ->transform(seconds())
      ->check(number_from_zero())
      ->capture_default_str()
      ->group(group::kCheckpoints);
}

}  // namespace

void add_render_options(CommandLine& command, RenderOptions& options) {
  constexpr const char* kEstimate = "Estimate";
  command
      .add_option("SCENE", options.scenes,
                  "Scene files: " + list_names(scene_formats()) + "; or job files, TOML with [[render]]")
      ->required()
      ->group(group::kInput);
  add_scene_text_options(command, options.scene);
  add_sampling_options(command, options.scene);
  add_scale_option(command, options.scene);
  add_region_options(command, options);
  add_effort_options(command, options);
  add_layer_options(command, options.scene);
  add_output_options(command, options);
  add_worker_options(command, options);
  add_web_option(command, options.web);
  command
      .add_option(
          "--address-file", options.address_file,
          "Write the address at which other hosts reach --listen into this file. Workers that are told "
          "file:FILE as address find it there, again when the render goes on on another host")
      ->type_name("FILE")
      ->check(some_text())
      ->needs("--listen")
      ->excludes("--pixel")
      ->group(group::kNetwork);
  command
      .add_option("--verify", options.verify,
                  "Share of the work units that a second worker renders too (0.05 is 5%). Where results "
                  "differ both workers are dismissed and their work is done again. Needs two workers")
      ->type_name("SHARE")
      ->check(number_between(0, 1))
      ->capture_default_str()
      ->group(group::kWorkers);
  add_checkpoint_options(command, options);
  Option* estimate =
      command
          .add_flag(
              "--estimate", options.estimate,
              "Render some passes for about ten seconds, and print what the whole render would take: "
              "core and wall time, memory, units, bytes, error; of several renders also the totals. No image "
              "is written")
          ->excludes("--pixel")
          ->group(kEstimate);
  command.add_flag("--json", options.json, "Print the estimate as JSON")->needs(estimate)->group(kEstimate);
  command.add_flag("-q,--quiet", options.quiet, "Print warnings and errors only")->group(group::kGeneral);
}

void show_common_render_options(CommandLine& command) {
  command.short_help({"SCENE", "-D", "--set", "--integrator", "--spp", "--seed", "--time-budget", "--scale",
                      "--crop", "--out", "--denoise", "--workers", "--threads", "--backend"});
}

void add_scene_overrides(CommandLine& command, SceneOptions& options) {
  add_scene_text_options(command, options);
  add_scale_option(command, options);
  add_sampling_options(command, options);
  add_layer_options(command, options);
}

void add_denoise_device_options(CommandLine& command, RenderOptions& options) {
  add_device_options(command, options);
}

void add_preview_options(CommandLine& command, RenderOptions& options) {
  options.interactive = true;
  options.samples_per_pass = 1;
  add_scene_options(command, options.scene);
  add_worker_options(command, options);
}

}  // namespace penumbra
