// `penumbra render SCENE`: scene file in, image files and report out.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "scheduler/cli/commands.h"
#include "scheduler/cli/loaded_scene.h"
#include "scheduler/cli/output_files.h"
#include "scheduler/cli/pixel_text.h"
#include "scheduler/cli/program_path.h"
#include "scheduler/cli/progress.h"
#include "scheduler/cli/stop_signal.h"
#include "scheduler/outputs/atomic_file.h"
#include "scheduler/outputs/film_image.h"
#include "scheduler/outputs/image_files.h"
#include "scheduler/outputs/report.h"

namespace penumbra {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// The film with the rectangle that the options ask for as its crop.
Expected<Film> cropped_film(const RenderOptions& options, Film film) {
  std::optional<CropRectangle> crop = options.crop;
  if (options.pixel) crop = {options.pixel->x, options.pixel->y, options.pixel->x + 1, options.pixel->y + 1};
  if (!crop) return film;
  if (crop->x1 > film.width || crop->y1 > film.height) {
    const char* option = options.pixel ? "--pixel" : "--crop";
    return fail(
        fmt::format("{} reaches outside the film, which is {} x {} pixels", option, film.width, film.height));
  }
  film.crop_x = crop->x0;
  film.crop_y = crop->y0;
  film.crop_width = crop->x1 - crop->x0;
  film.crop_height = crop->y1 - crop->y0;
  return film;
}

Expected<Isa> choose_isa(const std::optional<std::string>& name) {
  if (!name) return best_isa();
  const auto isa = isa_from_name(*name);
  if (isa && *isa > best_isa()) {
    return fail(
        fmt::format("--isa {}: this machine's widest instruction set is {}", *name, isa_name(best_isa())));
  }
  return isa;
}

Expected<DeviceOptions> device_options(const RenderOptions& options, const DeviceScene& scene) {
  DeviceOptions device;
  device.backend = options.backend == "opencl" ? Backend::kOpenCl : Backend::kNative;
  if (device.backend == Backend::kOpenCl && scene.header.intersector == INTERSECTOR_EMBREE) {
    return fail("this scene is rendered with Embree, which OpenCL has not: add --intersector portable");
  }
  const int cores = std::max(1, int(std::thread::hardware_concurrency()));
  device.threads = options.threads > 0 ? options.threads : std::max(1, cores / options.workers);
  device.opencl_device = options.opencl_device;
  const auto isa = choose_isa(options.isa);
  if (!isa) return std::unexpected(isa.error());
  device.isa = *isa;
  return device;
}

/// The one pixel is rendered as simply as can be: one worker, one thread, one path at a time.
void simplify_for_a_pixel(RenderJob& job) {
  job.workers = 1;
  job.device.threads = 1;
  job.device.block_of_one = job.device.backend == Backend::kNative;
}

RenderRecord make_record(const RenderOptions& options, const LoadedScene& scene, const Film& film,
                         const DeviceOptions& device) {
  RenderRecord record;
  record.scene = options.scene.scene;
  record.defines = options.scene.defines;
  record.settings = options.scene.settings;
  record.lenient = options.scene.lenient;
  record.film = film;
  record.sampler = scene.description.sampler;
  record.integrator = scene.description.integrator;
  record.samples_per_pass = options.samples_per_pass;
  record.feature_layers = !options.scene.no_features;
  record.embree = scene.device.header.intersector == INTERSECTOR_EMBREE;
  record.backend = device.backend;
  if (record.embree) record.isa = isa_name(device.isa);
  return record;
}

/// Least and most samples that a pixel has.
std::pair<std::uint64_t, std::uint64_t> sample_counts(const FilmAccumulator& film) {
  std::uint64_t least = std::numeric_limits<std::uint64_t>::max(), most = 0;
  for (int y = film.y(); y < film.y() + film.height(); ++y) {
    for (int x = film.x(); x < film.x() + film.width(); ++x) {
      least = std::min(least, film.at(x, y).count);
      most = std::max(most, film.at(x, y).count);
    }
  }
  return {least, most};
}

Expected<void> write_images(const Image& image, const OutputFiles& files) {
  using Encoder = Expected<std::vector<std::uint8_t>> (*)(const Image&);
  const std::pair<std::optional<std::filesystem::path>, Encoder> outputs[] = {{files.exr, encode_exr},
                                                                              {files.png, encode_png}};
  for (const auto& [path, encode] : outputs) {
    if (!path) continue;
    const auto bytes = encode(image);
    if (!bytes) return std::unexpected(bytes.error());
    if (auto written = write_file_atomically(*path, *bytes); !written) return written;
  }
  return {};
}

Expected<void> write_report(const RenderReport& report, const std::optional<std::filesystem::path>& path) {
  if (!path) return {};
  // Names and paths are bytes, not always UTF-8.
  const std::string text =
      report_json(report).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  return write_file_atomically(*path,
                               std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

void print_summary(const RenderOutcome& outcome, const OutputFiles& files) {
  std::vector<std::string> names;
  for (const auto& file : files.all()) names.push_back(file.string());
  const std::string where = names.empty() ? "" : fmt::format("wrote {}: ", fmt::join(names, ", "));
  const auto [least, most] = sample_counts(outcome.film);
  const std::string spp = least == most ? fmt::to_string(least) : fmt::format("{} to {}", least, most);
  fmt::print("{}{} x {} pixels, {} samples per pixel in {:.2f} s, {:.2f} Msamples/s\n", where,
             outcome.film.width(), outcome.film.height(), spp, outcome.seconds,
             samples_per_second(outcome) * 1e-6);
}

void print_problems(const RenderOutcome& outcome, bool stopped) {
  for (const std::string& problem : outcome.problems) print_warning(problem);
  const FilmAccumulator& film = outcome.film;
  if (film.nan_samples() + film.infinite_samples() > 0) {
    print_warning(fmt::format("{} NaN and {} infinite samples count as black", film.nan_samples(),
                              film.infinite_samples()));
  }
  if (outcome.complete) return;
  const auto [least, most] = sample_counts(film);
  print_error({fmt::format("{}; the image is incomplete, its pixels have {} to {} samples",
                           stopped ? "stopped by a signal" : "not all work could be done", least, most)});
}

ExitCode render(const RenderOptions& options, const std::vector<std::string>& command_line) {
  const std::atomic<bool>& stop = install_stop_signal();
  const auto bad_input = [](const Error& error) { return print_error(error), kBadInput; };
  const auto failed = [](const Error& error) { return print_error(error), kIncomplete; };

  const auto files = choose_output_files(options);
  if (!files) return bad_input(files.error());
  if (const auto writable = check_writable(*files); !writable) return bad_input(writable.error());
  auto scene = load_scene(options.scene);
  if (!scene) return bad_input(scene.error());
  for (const std::string& warning : scene->description.warnings) print_warning(warning);
  const auto film = cropped_film(options, scene->description.film);
  if (!film) return bad_input(film.error());
  const auto device = device_options(options, scene->device);
  if (!device) return bad_input(device.error());
  if (options.time_budget && scene->description.sampler.kind == SamplerKind::kStratified) {
    return bad_input(
        {"--time-budget: the stratified sampler has to know the number of samples; take another sampler"});
  }
  const auto worker = find_program("penumbra-worker");
  if (!worker) return failed(worker.error());

  RenderRecord record = make_record(options, *scene, *film, *device);
  RenderJob job;
  job.scene = std::move(scene->device);
  job.x = film->crop_x;
  job.y = film->crop_y;
  job.width = film->crop_width;
  job.height = film->crop_height;
  job.spp = record.sampler.spp;
  job.samples_per_pass = options.samples_per_pass;
  job.tile = options.tile;
  job.workers = options.workers;
  job.device = *device;
  job.worker_executable = worker->string();
  job.reproduce_command = repeat_command(record, false);
  job.time_budget = options.time_budget;
  if (options.pixel) simplify_for_a_pixel(job);

  ProgressPrinter progress(stderr,
                           options.quiet || options.pixel ? ProgressStyle::kNone : progress_style(stderr),
                           terminal_columns(stderr));
  const auto outcome = run_render(job, stop, [&](const RenderProgress& now) { progress.update(now); });
  progress.finish();
  if (!outcome) return failed(outcome.error());

  // What a time budget ended is repeated by the number of samples that it came to.
  if (outcome->complete) record.sampler.spp = std::uint32_t(sample_counts(outcome->film).first);

  const auto writing = Clock::now();
  Image image = image_of_film(outcome->film, film->width, film->height);
  image.metadata = record_metadata(record, outcome->film.hash(), outcome->complete);
  if (const auto written = write_images(image, *files); !written) return failed(written.error());

  RenderReport report;
  report.record = record;
  report.command_line = command_line;
  report.job = &job;
  report.outcome = &*outcome;
  report.warnings = scene->description.warnings;
  report.needs = scene->summary.needs;
  report.left_out = scene->summary.left_out;
  report.build_seconds = scene->seconds;
  report.write_seconds = seconds_since(writing);
  if (files->exr) report.files.push_back(*files->exr);
  if (files->png) report.files.push_back(*files->png);
  if (const auto written = write_report(report, files->report); !written) return failed(written.error());

  if (options.pixel) fmt::print("{}", pixel_text(outcome->film, options.pixel->x, options.pixel->y));
  if (!options.quiet && !options.pixel) print_summary(*outcome, *files);
  print_problems(*outcome, stop);
  return outcome->complete ? kAllDone : kIncomplete;
}

}  // namespace

void add_render_command(CLI::App& app, const std::vector<std::string>& command_line, Command& chosen) {
  CLI::App* command = app.add_subcommand("render", "Render a scene with worker processes on this machine");
  const auto options = std::make_shared<RenderOptions>();
  add_render_options(*command, *options);
  command->footer(
      "Writes the image as EXR with layers (see the README), the same as PNG (clamped, sRGB) and a JSON "
      "report.\n"
      "The image depends on scene, overrides, --spp, --seed and --pass alone (and with Embree on --isa): not "
      "on\n"
      "workers, threads or tiles. Ctrl-C keeps what is done, marked incomplete; a second Ctrl-C ends at "
      "once.\n"
      "By default one worker uses all cores; several cost a copy of the scene each and survive each other's "
      "crashes.\n\n"
      "Examples:\n"
      "  penumbra render scenes/cornell/scene.xml\n"
      "  penumbra render scene.xml -o out/a.exr --spp 256 --workers 4\n"
      "  penumbra render scene.xml -o preview.png --spp 4 --crop 0,0,256,256\n"
      "  penumbra render scene.xml -D albedo=0.5 --set integrator.max_depth=3 --integrator path_ems\n"
      "  penumbra render scene.xml --pixel 200,100 --spp 64");
  command->callback([options, &command_line, &chosen] {
    chosen = [options, &command_line] { return render(*options, command_line); };
  });
}

}  // namespace penumbra
