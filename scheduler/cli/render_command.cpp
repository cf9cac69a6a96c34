// `penumbra render SCENE`: renders a scene file to image files and statistics.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "scheduler/cli/commands.h"
#include "scheduler/cli/one_render.h"
#include "scheduler/estimate/estimate_text.h"
#include "scheduler/estimate/render_estimate.h"
#include "scheduler/files/program_path.h"
#include "scheduler/files/stop_signal.h"
#include "scheduler/record/film_image.h"
#include "scheduler/record/pixel_text.h"
#include "scheduler/run/option_hints.h"
#include "scheduler/run/render_checkpoint.h"
#include "scheduler/run/render_outputs.h"
#include "scheduler/run/render_preparation.h"
#include "scheduler/sets/job_file.h"
#include "scheduler/sets/render_set.h"
#include "scheduler/sets/set_estimate.h"
#include "worker/keys/address_file.h"

namespace penumbra {
namespace {

ExitCode estimate(const RenderOptions& options, const std::atomic<bool>& stop) {
  auto prepared = prepare_watched_render(options);
  if (!prepared) return prepared.error();
  const auto estimate = measure_estimate(options, *prepared, kEstimateSeconds, stop);
  if (!estimate) return print_error(estimate.error()), kIncomplete;
  if (options.json) {
    nlohmann::ordered_json json = {{"scene", prepared->record.scene.file}};
    json.update(estimate_json(*estimate));
    print_answer(json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  } else {
    print_answer(estimate_text(*estimate));
  }
  return stop ? kIncomplete : kAllDone;
}

/// Prepares the render with all checks, and attaches the checkpoint of an earlier process.
OneRender::Prepared prepare(const RenderOptions& options, bool show) {
  auto prepared = prepare_watched_render(options);
  if (!prepared) return prepared;
  const auto complain = [](const Error& error) {
    print_error(error);
    return std::unexpected(kBadInput);
  };
  if (options.verify > 0 && prepared->farm.workers < 2 && prepared->farm.listen.empty() &&
      prepared->farm.launch.empty())
    return complain({"--verify: it takes two workers: --workers 2, or --listen for others"});
  if (const auto made = make_folders(prepared->files); !made) return complain(made.error());
  const auto resumed = attach_checkpoint(*prepared, options, program_hash(prepared->farm.worker_executable));
  if (!resumed) return complain(resumed.error());
  if (show && !resumed->empty()) print_message(*resumed);
  return prepared;
}

ExitCode render(const RenderOptions& options, const std::vector<std::string>& command_line,
                const std::atomic<bool>& stop) {
  const bool show = !options.quiet && !options.pixel;
  OneRender one(options, command_line, stop, show);
  if (const auto ran = one.run([&] { return prepare(options, show); }); !ran)
    return stop ? kIncomplete : ran.error();
  PreparedRender& prepared = one.prepared();
  if (!one.outcome()) return print_error(nothing_to_write(true)), kIncomplete;
  const Expected<RenderOutcome>& outcome = *one.outcome();
  if (!outcome) return print_error(outcome.error()), kIncomplete;
  if (sample_range(outcome->film).total == 0) return print_problems(*outcome, stop), kIncomplete;
  if (!one.written()) {
    print_error(one.written().error());
    print_problems(*outcome, stop);
    return kIncomplete;
  }
  if (outcome->complete) remove_checkpoint(prepared);
  if (options.pixel) print_answer(pixel_text(outcome->film, options.pixel->x, options.pixel->y));
  if (show) print_summary(*outcome, prepared);
  if (show && prepared.scene.sampler_replaced) print_sampler_note();
  print_problems(*outcome, stop);
  const bool is_wrong = print_flagged(prepared, outcome->film);
  return outcome->complete && !is_wrong ? kAllDone : kIncomplete;
}

/// Tells workers that look for this scheduler later whether another one will follow: a render that a signal
/// has interrupted is continued by the next start of the same command.
ExitCode end_for_workers(const RenderOptions& options, ExitCode code, bool stopped) {
  if (options.address_file.empty()) return code;
  const bool is_interrupted = code == kIncomplete && stopped;
  if (const auto ended = end_address_file(options.address_file, is_interrupted); !ended) {
    print_error({"--address-file: " + ended.error().message});
    return code == kAllDone ? kIncomplete : code;
  }
  return code;
}

}  // namespace

void add_render_command(CommandLine& app, const std::vector<std::string>& command_line, Command& chosen) {
  CommandLine* command = app.add_command("render", "Render scenes");
  const auto options = std::make_shared<RenderOptions>();
  add_render_options(*command, *options);
  show_common_render_options(*command);
  command->short_help({"--estimate", "--listen", "--web"});
  command->footer(
      "Writes the image as EXR with layers (see the README), the same as PNG (clamped, sRGB), and statistics "
      "as JSON. The image depends on scene, overrides, --spp, --stop-after, --seed and --pass alone, with "
      "Embree also on --isa: not on workers or threads.\n\n"
      "Ctrl-C, or closing the terminal, keeps what is done, marked incomplete; a second Ctrl-C ends at once. "
      "What an interrupted or killed render has done is in IMAGE.checkpoint beside the image, and the same "
      "command continues it to the same image. Another render of that image is refused unless --restart "
      "replaces it.\n\n"
      "The files appear together at the end; missing folders are made. Of two renders to the same files, the "
      "last to end wins whole. Where the folder is full or gone by then, they go to TMPDIR (exit code 1).\n\n"
      "Several scenes are rendered one after the other by the same workers, each into its file in the folder "
      "-o. A bad scene does not stop the others; jobs.json there says what became of each. Images that are "
      "there and would be the same are kept (--force renders them again). A job file is TOML with [[render]] "
      "tables: scenes, seeds, integrators, frames and other options.\n\n"
      "By default one worker uses all cores. Several workers need a copy of the scene each, and survive each "
      "other's crashes.\n\n"
      "Examples:\n"
      "  penumbra render scenes/cornell/cornell.xml          cornell.exr, .png and .json in this folder\n"
      "  penumbra render scene.xml -o out/a.exr --spp 256 --workers 4\n"
      "  penumbra render a.xml b.xml -o out/ --spp 64        out/a.exr, out/b.exr, out/jobs.json, ...\n"
      "  penumbra render scene.xml -o out/a.exr --spp 4096   continues where it was interrupted\n"
      "  penumbra render rooms/*/scene.xml -o 'out/{folder}.exr'\n"
      "  penumbra render jobs.toml                           every render that the file describes\n"
      "  penumbra render shot.blend --frames 1-250           exported by Blender\n"
      "  penumbra render scene.xml -o preview.png --spp 4 --crop 0,0,256,256\n"
      "  penumbra render scene.xml -D albedo=0.5 --set integrator.max_depth=3 --integrator path_ems\n"
      "  penumbra render scene.xml --pixel 200,100 --spp 64");
  command->callback([options, command, &command_line, &chosen] {
    options->scene.file = options->scenes.front();
    chosen = [options, command, &command_line] {
      if (const auto checked = check_no_value_is_a_scene(*command, options->scenes); !checked)
        return print_error(checked.error()), kBadInput;
      const bool is_set = options->scenes.size() > 1 || !options->frames.empty() || !options->video.empty() ||
                          is_job_file(options->scenes.front());
      const std::atomic<bool>& stop = install_stop_signal();
      if (options->estimate)
        return is_set ? estimate_set(*options, *command, stop) : estimate(*options, stop);
      const ExitCode code =
          is_set ? render_set(*options, *command, command_line, stop) : render(*options, command_line, stop);
      return end_for_workers(*options, code, stop);
    };
  });
}

}  // namespace penumbra
