#include "scheduler/cli/render_options.h"
#include "scheduler/keys/access_options.h"

#include <charconv>
#include <span>

#include "kernels/host/device_scene.h"
#include "scenes/diagnostic.h"
#include "scenes/scene_reader.h"
#include "scenes/settings.h"
#include "scheduler/cli/option_checks.h"
#include "scheduler/plan/work_unit.h"
#include "worker/device.h"

namespace penumbra {
namespace {

/// Exactly `values.size()` non-negative integers with commas between.
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

void add_overrides(CLI::App& command, SceneOptions& options);

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

void add_scene_options(CLI::App& command, SceneOptions& options) {
  command.add_option("SCENE", options.scene, "Scene file: " + list_names(scene_formats()))->required();
  add_overrides(command, options);
}

namespace {

void add_overrides(CLI::App& command, SceneOptions& options) {
  command
      .add_option("-D", options.defines, "Fill $NAME of the scene file, as in -D albedo=0.5; may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false)
      ->check(assignment());
  command
      .add_option(
          "--set", options.settings,
          "Override a parameter of integrator, sampler, film or camera, as in --set integrator.max_depth=3; "
          "may be repeated; `penumbra settings` lists them")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->check(assignment());
  command.add_flag("--lenient", options.lenient,
                   "Warn of what is not known, missing or out of range, and render the rest");
  command
      .add_option(
          "--dialect", options.dialect,
          "Of Nori's scenes: nori, or nori-eth for those of ETH Zurich's course, whose camera is mirrored "
          "(default: what the file tells; `penumbra info` says which)")
      ->type_name("NAME")
      ->check(CLI::IsMember({"nori", "nori-eth"}));
  command.add_flag("--strict", options.strict, "Every warning about the scene is an error");
  command
      .add_option("--integrator", options.integrator, "Override the scene's integrator (path is path_mis)")
      ->type_name("NAME")
      ->check(CLI::IsMember(find_setting("integrator.type")->choices));
  command.add_option("--sampler", options.sampler, "Override the scene's sampler")
      ->type_name("NAME")
      ->check(CLI::IsMember(find_setting("sampler.type")->choices));
  command.add_option("--spp", options.spp, "Samples per pixel (default: the scene's)")
      ->type_name("N")
      ->check(whole_number(1, kMaxSamplesPerPixel));
  command.add_option("--seed", options.seed, "Seed of all random numbers (default: the scene's, or 0)")
      ->type_name("S")
      ->check(whole_number(0, kMaxSeed));
  command
      .add_option(
          "--intersector", options.intersector,
          "portable gives the same bits on every machine, embree is faster in large scenes, auto chooses by "
          "the size of the scene")
      ->type_name("NAME")
      ->check(CLI::IsMember({"auto", "portable", "embree"}))
      ->capture_default_str();
  command.add_flag("--no-features", options.no_features, "Leave out the albedo, normal and depth layers");
}

/// Options for workers and viewers.
void add_worker_options(CLI::App& command, RenderOptions& options) {
  command
      .add_option("--tile", options.tile,
                  "Pixels along a side of a work unit; the image does not depend on it, but for "
                  "--target-error and --adaptive")
      ->type_name("N")
      ->check(whole_number(1, kMaxTile))
      ->capture_default_str();

  CLI::Option* workers = command
                             .add_option("--workers", options.workers,
                                         "Worker processes on this machine, each with a copy of the scene")
                             ->type_name("N")
                             ->check(whole_number(1, kMaxWorkers))
                             ->capture_default_str();
  command
      .add_option(
          "--launch", options.launch,
          "Start the workers by this command, as in --launch 'srun -n 32', instead of here. They "
          "connect to --listen (without it only workers on this machine can), and use as many threads "
          "as they are given cores, or --threads")
      ->type_name("COMMAND")
      ->excludes(workers);
  command.add_option("--threads", options.threads, "Threads of each worker (default: cores / workers)")
      ->type_name("N")
      ->check(whole_number(1, kMaxThreads));
  command
      .add_option("--backend", options.backend,
                  "What computes; auto: OpenCL where there is a device that is no CPU and renders the same "
                  "bits, else "
                  "native. Compiled kernels are kept in ~/.cache/penumbra/kernels: "
                  "PENUMBRA_KERNEL_CACHE=FOLDER or off")
      ->type_name("NAME")
      ->check(CLI::IsMember({"native", "opencl", "auto"}))
      ->capture_default_str();
  command
      .add_option("--opencl-device,--device", options.opencl_device,
                  "With --backend opencl or auto: number of an OpenCL device, or part of its or its "
                  "platform's name (default: the first CPU "
                  "device, else any); `penumbra worker --list-devices` lists them")
      ->type_name("NAME");
  command
      .add_option("--isa", options.isa,
                  "Instruction set of the native backend (default: the widest there is)")
      ->type_name("NAME")
      ->check(CLI::IsMember({"sse2", "avx2", "avx512"}));
  command
      .add_option(
          "--listen", options.listen,
          "Another address for windows and workers: unix:/path, or 127.0.0.1:PORT (0: any free one), where a "
          "token is asked for, which is printed; with --keys also of other hosts, 0.0.0.0:PORT for all")
      ->type_name("ADDRESS")
      ->check(some_text());
  add_keys_option(command, options.keys, "TLS and tokens for --listen HOST:PORT");
  command
      .add_option("--tev", options.tev,
                  "Show the render in a running tev while it converges (tev's own address is "
                  "127.0.0.1:14158)")
      ->type_name("HOST:PORT");
}

}  // namespace

void add_render_options(CLI::App& command, RenderOptions& options) {
  command
      .add_option("SCENE", options.scenes,
                  "Scene files: " + list_names(scene_formats()) + "; or job files, TOML with [[render]]")
      ->required();
  add_overrides(command, options.scene);
  command
      .add_option(
          "-o,--out", options.out,
          "x.exr writes x.exr and x.png, x.png only that; a folder: the scene's name in it (default: the "
          "scene's name with .exr in the current folder). Of several scenes a folder, or a name with fields: "
          "{scene}, {folder}, the scene's own, {seed:03} and what else a render is given")
      ->type_name("FILE");
  auto* statistics =
      command.add_option("--statistics,--report", options.statistics,
                         "JSON of settings, rates, times, memory and workers (default: beside the "
                         "image, .json)");
  statistics->type_name("FILE");
  command.add_flag("--no-statistics,--no-report", options.no_statistics, "Write none")->excludes(statistics);

  command.add_flag(
      "--cryptomatte", options.scene.cryptomatte,
      "Layers of objects and materials in the EXR, from which compositing programs make mattes by "
      "their names");
  auto* crop = command.add_option_function<std::string>(
      "--crop",
      [&options](const std::string& text) {
        options.crop = parse_crop(text);
        if (options.crop) return;
        throw CLI::ValidationError("--crop",
                                   "'" + text + "' is not x0,y0,x1,y1 with 0 <= x0 < x1, 0 <= y0 < y1");
      },
      "Render only these film pixels, x1 and y1 outside; they are those of the whole image");
  crop->type_name("X0,Y0,X1,Y1");
  auto* pixel = command.add_option_function<std::string>(
      "--pixel",
      [&options](const std::string& text) {
        options.pixel = parse_pixel(text);
        if (options.pixel) return;
        throw CLI::ValidationError("--pixel", "'" + text + "' is not x,y with x and y from 0 up");
      },
      "Render one pixel, a path at a time, and print all its digits; writes files only with -o");
  pixel->type_name("X,Y")->excludes(crop);
  CLI::Option* stop_after =
      command.add_option("--stop-after", options.stop_after,
                         "Render only the first N samples per pixel of a sequence made for --spp");
  stop_after->type_name("N")->check(whole_number(1, kMaxSamplesPerPixel));
  command
      .add_option(
          "--stop-after-units", options.stop_after_units,
          "Render only the first N pieces of work, pass by pass (--pass) and tile by tile (--tile): what a "
          "time budget ended, again")
      ->type_name("N")
      ->check(whole_number(1, std::int64_t(1) << 62))
      ->excludes(stop_after);
  command
      .add_option(
          "--time-budget", options.time_budget,
          "Begin no further tile after this many seconds of rendering; the first pass is always rendered")
      ->type_name("SECONDS")
      ->check(positive_number());
  command
      .add_option(
          "--target-error", options.target_error,
          "Render each tile until its relative error, estimated without bias from stopping, is at most "
          "this (0.02 is 2%), and at most --spp samples; with --sampler independent. The image then "
          "depends on --tile")
      ->type_name("E")
      ->check(positive_number())
      ->excludes("--stop-after-units");
  command
      .add_flag(
          "--adaptive", options.adaptive,
          "Share out the samples among the tiles by the error that two more samples of each pixel show: "
          "--spp is then what their mean comes to at most. Without bias; the image depends on --tile")
      ->excludes("--target-error")
      ->excludes(stop_after)
      ->excludes("--stop-after-units")
      ->excludes(pixel);
  command
      .add_option("--pass", options.samples_per_pass,
                  "Samples of a pixel in one work unit; the image's last bits depend on it")
      ->type_name("N")
      ->check(whole_number(1, kMaxSamplesPerUnit))
      ->capture_default_str();
  add_worker_options(command, options);
  command
      .add_option("--verify", options.verify,
                  "Let a second worker render this share of the work units, too, and compare the results "
                  "(0.05 is 5%): both workers are sent away where they differ, and what they did is done "
                  "again. It takes two workers")
      ->type_name("SHARE")
      ->check(number_between(0, 1))
      ->capture_default_str();
  command.add_flag(
      "--strict-numerics", options.strict_numerics,
      "NaN and infinite samples, and such through media whose boundaries contradict each other, are an "
      "error (exit code 1) instead of a warning; files are written");
  command.add_flag("--force", options.force,
                   "Of several scenes, render also those whose images are there and would be the same");
  command
      .add_option("--summary", options.summary,
                  "Of several scenes, JSON of what became of each (default: jobs.json beside the job file, "
                  "or the images)")
      ->type_name("FILE");
  CLI::Option* resume =
      command
          .add_flag("--resume", options.resume,
                    "Go on with what an interrupted run of this very render has left beside its image "
                    "(IMAGE.checkpoint), as is done anyway; say so if there is nothing")
          ->excludes(pixel);
  command.add_flag("--restart", options.restart, "Begin anew, and replace what an interrupted run has left")
      ->excludes(resume);
  command
      .add_option("--checkpoint-interval", options.checkpoint_interval,
                  "Keep what is rendered so often, or less often where that would take more than 1% of the "
                  "time; 0: never")
      ->type_name("SECONDS")
      ->check(number_from_zero())
      ->capture_default_str();
  CLI::Option* estimate = command.add_flag(
      "--estimate", options.estimate,
      "Render a few passes, for some ten seconds, and print what all of it would cost: core time, wall time, "
      "memory, units, bytes, error; no image is written");
  estimate->excludes(pixel);
  command.add_flag("--json", options.json, "With --estimate: print JSON")->needs(estimate);
  command.add_flag("-q,--quiet", options.quiet, "No progress and no summary; warnings and errors only");
}

void add_preview_options(CLI::App& command, RenderOptions& options) {
  options.interactive = true;
  options.samples_per_pass = 1;
  add_scene_options(command, options.scene);
  add_worker_options(command, options);
}

}  // namespace penumbra
