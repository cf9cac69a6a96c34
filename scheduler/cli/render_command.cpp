// `penumbra render SCENE`: scene file in, image files and statistics out.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "kernels/host/stopwatch.h"
#include "kernels/host/words.h"
#include "scheduler/cli/commands.h"
#include "scheduler/cli/pixel_text.h"
#include "scheduler/cli/progress.h"
#include "scheduler/cli/render_preparation.h"
#include "scheduler/cli/scene_costs.h"
#include "scheduler/cli/stop_signal.h"
#include "scheduler/files/output_batch.h"
#include "scheduler/image/image_files.h"
#include "scheduler/record/film_image.h"
#include "scheduler/record/non_finite_text.h"
#include "scheduler/record/render_statistics.h"

namespace penumbra {
namespace {

using Clock = std::chrono::steady_clock;

/// Image files, written aside.
Expected<void> add_images(const Image& image, const OutputFiles& files, OutputBatch& batch) {
  using Encoder = Expected<std::vector<std::uint8_t>> (*)(const Image&);
  const std::pair<std::optional<std::filesystem::path>, Encoder> outputs[] = {{files.exr, encode_exr},
                                                                              {files.png, encode_png}};
  for (const auto& [path, encode] : outputs) {
    if (!path) continue;
    auto bytes = encode(image);
    if (!bytes) return std::unexpected(bytes.error());
    batch.add(*path, std::move(*bytes));
  }
  return {};
}

void add_statistics(const RenderStatistics& statistics, const std::filesystem::path& path,
                    OutputBatch& batch) {
  // Names and paths are bytes, not always UTF-8.
  const std::string text =
      statistics_json(statistics).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  batch.add(path, {text.begin(), text.end()});
}

std::string samples_text(std::uint64_t least, std::uint64_t most) {
  return least == most ? counted(least, "sample") : fmt::format("{} to {} samples", least, most);
}

void print_summary(const RenderOutcome& outcome, const OutputFiles& files) {
  std::vector<std::string> names;
  for (const auto& file : files.all()) names.push_back(file.string());
  const std::string where = names.empty() ? "" : fmt::format("wrote {}: ", fmt::join(names, ", "));
  const auto [least, most, total] = sample_range(outcome.film);
  const std::string spp = samples_text(least, most);
  print_remark(fmt::format("{}{} x {} pixels, {} per pixel in {:.2f} s, {:.2f} Msamples/s\n", where,
                           outcome.film.width(), outcome.film.height(), spp, outcome.seconds,
                           samples_per_second(outcome) * 1e-6));
}

/// Non-finite samples, and variances that no file holds, as warnings or as errors; whether there are
/// any.
bool print_non_finite(const FilmAccumulator& film, const std::string& reproduce_command, bool strict) {
  const std::pair<NonFiniteSamples, const char*> kinds[] = {{film.nan(), "NaN"},
                                                            {film.infinite(), "infinite"}};
  std::vector<std::string> texts;
  for (const auto& [samples, kind] : kinds)
    if (samples.count > 0) texts.push_back(non_finite_text(samples, kind, reproduce_command));
  if (const std::uint64_t pixels = pixels_of_infinite_variance(film); pixels > 0)
    texts.push_back(fmt::format(
        "the variance of {} is more than a file's single precision holds, and infinite there; the "
        "radiance is as it should be. Scale the lights down",
        counted(pixels, "pixel")));
  for (const std::string& text : texts) {
    if (strict) {
      print_error({text});
    } else {
      print_warning(text);
    }
  }
  return !texts.empty();
}

void print_problems(const RenderOutcome& outcome, bool stopped) {
  for (const std::string& problem : outcome.problems) print_warning(problem);
  const FilmAccumulator& film = outcome.film;
  if (outcome.complete) return;
  const char* why = stopped ? "stopped by a signal" : "not all work could be done";
  const auto [least, most, total] = sample_range(film);
  if (total == 0) {
    print_error({fmt::format("{}; there is nothing to write", why)});
  } else {
    print_error(
        {fmt::format("{}; the image is incomplete, its pixels have {}", why, samples_text(least, most))});
  }
}

/// Image files and statistics, with the record of as many samples as the render came to.
Expected<void> write_outputs(PreparedRender& prepared, const RenderOutcome& outcome,
                             const std::vector<std::string>& command_line) {
  const auto begin = Clock::now();
  const OutputFiles& files = prepared.files;
  OutputBatch batch;
  RenderStatistics statistics;
  const RenderedSamples rendered = rendered_samples(outcome);
  statistics.record = record_of_rendered(std::move(prepared.record), rendered);
  if (files.exr || files.png) {
    Image image = image_of_film(outcome.film, statistics.record.film.width, statistics.record.film.height);
    image.metadata = record_metadata(statistics.record, outcome.film.hash(), rendered);
    if (auto encoded = add_images(image, files, batch); !encoded) return encoded;
  }
  statistics.command_line = command_line;
  statistics.job = &prepared.job;
  statistics.workers = prepared.farm.workers;
  statistics.outcome = &outcome;
  statistics.warnings = prepared.scene.description.warnings;
  statistics.needs = prepared.scene.summary.needs;
  statistics.left_out = prepared.scene.summary.left_out;
  if (files.statistics)
    statistics.inventory =
        scene_costs(prepared.scene.description, prepared.job.scene, prepared.job.device.isa, false);
  statistics.build_seconds = prepared.scene.seconds;
  statistics.write_seconds = seconds_since(begin);
  if (files.exr) statistics.files.push_back(*files.exr);
  if (files.png) statistics.files.push_back(*files.png);
  if (files.statistics) add_statistics(statistics, *files.statistics, batch);
  return batch.finish();
}

/// Renders. Where the machine was to choose what computes, and its choice brings down every worker (a driver
/// that crashes is none that fails), native code renders after all.
Expected<RenderOutcome> render_with_fallback(RenderJob& job, const FarmOptions& farm,
                                             const std::atomic<bool>& stop,
                                             const std::function<void(const RenderProgress&)>& on_progress) {
  auto outcome = run_render(job, farm, stop, on_progress);
  if (outcome || job.device.backend != Backend::kAuto || stop) return outcome;
  std::string warning = "native code renders: " + outcome.error().message;
  job.device.backend = Backend::kNative;
  outcome = run_render(job, farm, stop, on_progress);
  if (outcome) outcome->problems.insert(outcome->problems.begin(), std::move(warning));
  return outcome;
}

ExitCode render(const RenderOptions& options, const std::vector<std::string>& command_line) {
  const std::atomic<bool>& stop = install_stop_signal();
  auto prepared = prepare_watched_render(options);
  if (!prepared) return prepared.error();
  if (const auto made = make_folders(prepared->files); !made) return print_error(made.error()), kBadInput;

  const bool show = !options.quiet && !options.pixel;
  ProgressPrinter progress(show ? progress_style() : ProgressStyle::kNone, terminal_columns());
  const auto outcome =
      render_with_fallback(prepared->job, prepared->farm, stop, [&](const RenderProgress& now) {
        progress.update(now);
        // The address and its token are printed even so, since the user asked for an address.
        if (!show && !options.listen.empty())
          for (const std::string& notice : now.notices) print_message(notice);
      });
  progress.finish();
  if (!outcome) return print_error(outcome.error()), kIncomplete;
  if (sample_range(outcome->film).total == 0) {
    print_problems(*outcome, stop);  // an image that exists is worth more than a black one
    return kIncomplete;
  }
  if (const auto written = write_outputs(*prepared, *outcome, command_line); !written) {
    print_error(written.error());
    print_problems(*outcome, stop);
    return kIncomplete;
  }
  if (options.pixel) print_answer(pixel_text(outcome->film, options.pixel->x, options.pixel->y));
  if (show) print_summary(*outcome, prepared->files);
  print_problems(*outcome, stop);
  const bool non_finite =
      print_non_finite(outcome->film, prepared->job.reproduce_command, options.strict_numerics);
  return outcome->complete && !(non_finite && options.strict_numerics) ? kAllDone : kIncomplete;
}

}  // namespace

void add_render_command(CLI::App& app, const std::vector<std::string>& command_line, Command& chosen) {
  CLI::App* command = app.add_subcommand("render", "Render a scene with worker processes on this machine");
  const auto options = std::make_shared<RenderOptions>();
  add_render_options(*command, *options);
  command->footer(
      "Writes the image as EXR with layers (see the README), the same as PNG (clamped, sRGB) and a JSON "
      "statistics.\n"
      "The image depends on scene, overrides, --spp, --stop-after, --seed and --pass alone (and with Embree "
      "on --isa): not "
      "on\n"
      "workers, threads or tiles. Ctrl-C, or a terminal that is closed, keeps what is done, marked "
      "incomplete; a "
      "second\n"
      "Ctrl-C ends at once. The files appear together at the end, and missing folders are made; of two "
      "renders to "
      "the same\n"
      "files the one that ends last wins whole. Where the folder is full or gone by then, they go to TMPDIR "
      "(exit "
      "code 1).\n"
      "By default one worker uses all cores; several cost a copy of the scene each and survive each other's "
      "crashes.\n\n"
      "Examples:\n"
      "  penumbra render scenes/cornell/cornell.xml              writes cornell.exr, cornell.png, "
      "cornell.json here\n"
      "  penumbra render scene.xml -o out/a.exr --spp 256 --workers 4\n"
      "  penumbra render scene.xml -o preview.png --spp 4 --crop 0,0,256,256\n"
      "  penumbra render scene.xml -D albedo=0.5 --set integrator.max_depth=3 --integrator path_ems\n"
      "  penumbra render scene.xml --pixel 200,100 --spp 64");
  command->callback([options, &command_line, &chosen] {
    chosen = [options, &command_line] { return render(*options, command_line); };
  });
}

}  // namespace penumbra
