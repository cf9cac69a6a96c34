#include "scheduler/run/render_options.h"

#include <functional>

#include "scenes/diagnostic.h"
#include "scenes/scene_reader.h"
#include "scheduler/render/frames.h"
#include "scheduler/render/option_checks.h"
#include "scheduler/render/render_option.h"
#include "scheduler/run/option_hints.h"
#include "worker/cli/access_options.h"
#include "worker/cli/help_text.h"

namespace penumbra {
namespace {

ValueKind value_kind(OptionKind kind) {
  switch (kind) {
    case OptionKind::kFlag:
      return ValueKind::kFlag;
    case OptionKind::kInteger:
    case OptionKind::kCount:
      return ValueKind::kInteger;
    case OptionKind::kNumber:
      return ValueKind::kNumber;
    default:
      return ValueKind::kText;
  }
}

Option* add_option(CommandLine& command, const RenderOption& row, RenderRequest& request) {
  const auto take = [&row, &request](std::string text) { return row.apply(request, text); };
  Option* option = nullptr;
  if (row.is_flag()) {
    option = command.add_flag_function(row.names, take, row.help);
  } else if (row.kind == OptionKind::kList) {
    const auto take_all = [take](const std::vector<std::string>& texts) {
      Expected<void> taken;
      for (const std::string& text : texts)
        if (taken) taken = take(text);
      return taken;
    };
    option = command.add_option_function(row.names, take_all, row.help)->allow_extra_args(false);
  } else {
    option = command.add_option_function(row.names, std::function<Expected<void>(const std::string&)>(take),
                                         row.help);
  }
  option->kind(value_kind(row.kind))
      ->group(row.group)
      ->transform({[&row](std::string& text) {
                     if (row.kind == OptionKind::kFlag) text = flag_word(text);
                     RenderRequest none;
                     const auto applied = row.apply(none, text);
                     return applied ? std::string() : applied.error().message;
                   },
                   row.limits});
  if (!row.value.empty()) option->type_name(row.value);
  if (row.shows_default) option->default_str(row.print({}).front());
  return option;
}

/// Adds the options for which `is_meant`, in the order of their rows.
void add_options(CommandLine& command, RenderRequest& request,
                 const std::function<bool(const RenderOption&)>& is_meant) {
  for (const RenderOption& row : all_render_options())
    if (is_meant(row)) add_option(command, row, request);
}

void add_group(CommandLine& command, RenderRequest& request, std::string_view group) {
  add_options(command, request, [group](const RenderOption& row) { return row.group == group; });
}

void exclude_options(const CommandLine& command) {
  for (const RenderOption& row : all_render_options())
    for (const std::string& other : row.excludes) command.option(row.word())->excludes("--" + other);
}

void explain_options(CommandLine& command) {
  command.explain([&command](const std::string& word) { return option_hint(command, word); });
}

/// Options for where the workers come from.
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
}

/// Options for who may connect.
void add_network_options(CommandLine& command, RenderOptions& options) {
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

/// Options for shots.
void add_shot_options(CommandLine& command, RenderOptions& options) {
  command
      .add_option(
          "--frames", options.frames,
          "Render these frames, each into its file: 1-250, 1-250x2 (every second), 300, 1-10,50-60. Names "
          "have the field #### or {frame:04}, else .0001 before their extension. Frames that are there "
          "and would be the same are kept")
      ->type_name("LIST")
      ->check({[](const std::string& text) {
                 const auto frames = frames_of(text);
                 return frames ? std::string() : frames.error().message;
               },
               ""})
      ->excludes("--frame")
      ->excludes("--pixel")
      ->group(group::kFrames);
  command
      .add_option_function(
          "--order", std::function<Expected<void>(const std::string&)>([&options](const std::string& text) {
            options.preview_order = text == "preview";
            return Expected<void>();
          }),
          "ascending, or preview: the first frame, the last, the middle, then halves")
      ->type_name("ORDER")
      ->check(one_of({"ascending", "preview"}))
      ->needs("--frames")
      ->group(group::kFrames);
  command
      .add_option("--video", options.video,
                  "At the end, make a video of the frames' PNGs by the program ffmpeg. Frames that failed "
                  "hold the picture before")
      ->type_name("FILE.mp4")
      ->check({[](const std::string& text) {
                 return text.ends_with(".mp4") ? std::string()
                                               : "a video is written as FILE.mp4, not as '" + text + "'";
               },
               ""})
      ->excludes("--pixel")
      ->group(group::kFrames);
  command
      .add_option(
          "--time-radius", options.time_radius,
          "With --denoise, frames before, and after, whose light a frame takes; 0: none. Adds the layer "
          "motion. Noise of their own (--seed-per-frame frame) lets frames flicker less")
      ->check(whole_number(0, kMostTimeRadius))
      ->capture_default_str()
      ->type_name("N")
      ->group(group::kFrames);
  command
      .add_flag("--no-contact-sheet", options.no_sheet,
                "Of frames, do not write NAME-contact.png with small pictures of them beside the images")
      ->group(group::kFrames);
}

/// Options for several scenes.
void add_set_options(CommandLine& command, RenderOptions& options) {
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

Option* add_render_option(CommandLine& command, RenderRequest& request, std::string_view name) {
  return add_option(command, *find_render_option(name), request);
}

void add_web_option(CommandLine& command, std::string& address) {
  command
      .add_option("--web", address,
                  "Show jobs, images and workers in a browser: 127.0.0.1:PORT (0: a free port). The link is "
                  "printed. With --keys other hosts too, encrypted")
      ->type_name("ADDRESS")
      ->check(some_text())
      ->group(group::kNetwork);
}

void add_render_options(CommandLine& command, RenderOptions& options) {
  constexpr const char* kEstimate = "Estimate";
  explain_options(command);
  command
      .add_option("SCENE", options.scenes,
                  "Scene files: " + list_names(scene_formats()) + "; or job files, TOML with [[render]]")
      ->required()
      ->group(group::kInput);
  for (const char* group : {group::kInput, group::kFrames, group::kSampling, group::kRegion, group::kOutput})
    add_group(command, options, group);
  add_shot_options(command, options);
  add_set_options(command, options);
  add_worker_options(command, options);
  add_group(command, options, group::kWorkers);
  exclude_options(command);
  add_network_options(command, options);
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
  command
      .add_option(
          "--progress", options.progress,
          "How progress is shown: bar, lines, or json: an object a line on stdout, where with --quiet "
          "nothing else is (default: bar on a terminal, else lines)")
      ->type_name("STYLE")
      ->check(one_of({"bar", "lines", "json"}))
      ->group(group::kGeneral);
}

void show_common_render_options(CommandLine& command) {
  command.short_help({"SCENE", "-D", "--set", "--integrator", "--spp", "--seed", "--time-budget", "--scale",
                      "--crop", "--out", "--denoise", "--workers", "--threads", "--backend"});
}

void add_scene_options(CommandLine& command, RenderRequest& request) {
  command.add_option("SCENE", request.scene.file, "Scene file: " + list_names(scene_formats()))
      ->required()
      ->group(group::kInput);
  add_scene_overrides(command, request);
}

void add_scene_overrides(CommandLine& command, RenderRequest& request) {
  explain_options(command);
  add_options(command, request, [](const RenderOption& row) { return row.part == OptionPart::kScene; });
}

void add_device_options(CommandLine& command, RenderRequest& request) {
  add_options(command, request, [](const RenderOption& row) { return row.part == OptionPart::kDevice; });
}

void add_preview_options(CommandLine& command, RenderOptions& options) {
  options.interactive = true;
  options.plan.samples_per_pass = 1;
  add_scene_options(command, options);
  add_worker_options(command, options);
  add_device_options(command, options);
  add_render_option(command, options, "tile");
  add_network_options(command, options);
}

}  // namespace penumbra
