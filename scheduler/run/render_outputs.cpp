#include "scheduler/run/render_outputs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <iterator>
#include <nlohmann/json.hpp>

#include "kernels/host/console.h"
#include "kernels/host/process.h"
#include "kernels/host/text.h"
#include "scheduler/files/output_batch.h"
#include "scheduler/image/image_files.h"
#include "scheduler/record/camera_attributes.h"
#include "scheduler/record/cryptomatte.h"
#include "scheduler/record/film_image.h"
#include "scheduler/record/flagged_text.h"
#include "scheduler/record/render_statistics.h"
#include "scheduler/run/scene_costs.h"

namespace penumbra {
namespace {

using Clock = std::chrono::steady_clock;

using OptionalPath = std::optional<std::filesystem::path>;

}  // namespace

void add_images(const Image& image, const Film& format, const std::optional<std::filesystem::path>& exr,
                const std::optional<std::filesystem::path>& png, OutputBatch& batch) {
  if (exr)
    batch.add_aside(*exr, [&image, encoding = ExrEncoding{format.compression, format.half}] {
      return encode_exr(image, encoding);
    });
  if (png) batch.add_aside(*png, [&image] { return encode_png(image); });
  if (const std::uint64_t beyond = exr && format.half ? values_beyond_half(image) : 0; beyond > 0)
    print_warning(fmt::format("{} more than 16 bits hold and 65504 in {}; component_format float32 has them",
                              beyond == 1 ? "1 value is" : fmt::format("{} values are", beyond),
                              exr->string()));
}

void add_statistics(const nlohmann::ordered_json& statistics, const std::filesystem::path& path,
                    OutputBatch& batch) {
  // Names and paths may be invalid UTF-8.
  const std::string text = statistics.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  batch.add(path, {text.begin(), text.end()});
}

namespace {

/// Denoises the image on all cores and writes the result.
Expected<void> write_denoised(const Image& image, const Film& film, const OutputFiles& files) {
  const auto denoised = denoise_image(image, denoise_options(film));
  if (!denoised) return fail("it cannot be denoised: " + denoised.error().message);
  OutputBatch batch;
  add_images(denoised->image, film, files.denoised_exr, files.denoised_png, batch);
  return batch.finish();
}

const char* why_incomplete(bool stopped) {
  return stopped ? "stopped by a signal" : "not all work could be done";
}

std::string samples_text(std::uint64_t least, std::uint64_t most) {
  return least == most ? counted(least, "sample") : fmt::format("{} to {} samples", least, most);
}

std::string range_text(std::uint64_t least, std::uint64_t most) {
  return least == most ? fmt::to_string(least) : fmt::format("{}–{}", least, most);
}

/// The samples per pixel; if a time budget ended the render, also out of how many.
std::string samples_of_pixel(const RenderOutcome& outcome, const RenderJob& job) {
  const SampleRange range = sample_range(outcome.film);
  if (!ended_by_budget(outcome, job)) return samples_text(range.least, range.most) + " per pixel";
  return fmt::format("{} of {} samples per pixel: ended by the budget,", range_text(range.least, range.most),
                     job.spp);
}

/// For BAD_BOUNDARY the name of the shape that the first such sample hit.
std::string shape_of_first(const PreparedRender& prepared, const FlaggedSamples& samples) {
  const auto name = prepared.scene.boundary_names.find(samples.shape);
  return name != prepared.scene.boundary_names.end() ? name->second : "";
}

}  // namespace

DenoiseOptions denoise_options(const Film& film) {
  return {.method = film.denoise, .nl_means = {}, .device = {.threads = 0, .isa = best_isa()}};
}

bool ended_by_budget(const RenderOutcome& outcome, const RenderJob& job) {
  return outcome.complete && job.request.time_budget && !outcome.ended_by_tile &&
         sample_range(outcome.film).least < std::uint64_t(job.spp);
}

void print_summary(const RenderOutcome& outcome, const PreparedRender& prepared) {
  std::vector<std::string> names;
  for (const auto& file : prepared.files.all()) names.push_back(file.string());
  const std::string where = names.empty() ? "" : fmt::format("wrote {}: ", fmt::join(names, ", "));
  print_remark(fmt::format("{}{} x {} pixels, {} in {:.2f} s, {:.2f} Msamples/s\n", where,
                           outcome.film.width(), outcome.film.height(),
                           samples_of_pixel(outcome, prepared.job), outcome.seconds,
                           samples_per_second(outcome) * 1e-6));
}

void print_sampler_note() {
  print_remark("note: sobol replaces the scene's independent sampler; --sampler scene keeps it\n");
}

// At edges, and where a boundary meets another surface, rounding decides which one is crossed first. In a
// closed scene about 1 in 100 000 samples seem contradictory for this reason.
constexpr double kContradictionsByRounding = 1e-4;
// With more non-finite samples than this, the image is considered incomplete.
constexpr double kMostNonFinite = 0.01;

bool print_flagged(const PreparedRender& prepared, const FilmAccumulator& film) {
  const bool strict = prepared.job.request.strict_numerics;
  const FlaggedByKind flagged = film.flagged();
  const auto samples_in_all = double(sample_range(film).total);
  const double rounded = kContradictionsByRounding * samples_in_all;
  const bool is_spoilt = double(non_finite_count(flagged)) > kMostNonFinite * samples_in_all;
  std::vector<std::string> texts;
  for (int kind = 0; kind < BAD_KINDS; ++kind)
    if (const FlaggedSamples& samples = flagged[std::size_t(kind)];
        double(samples.count) > (kind == BAD_BOUNDARY ? rounded : 0.0))
      texts.push_back(
          flagged_text(kind, samples, shape_of_first(prepared, samples), prepared.job.reproduce_command));
  if (const std::uint64_t pixels = pixels_of_infinite_variance(film); pixels > 0)
    texts.push_back(fmt::format(
        "the variance of {} is more than a file's single precision holds, and infinite there; the "
        "radiance is as it should be. Scale the lights down",
        counted(pixels, "pixel")));
  for (const std::string& text : texts) {
    if (strict || is_spoilt) {
      print_error({text});
    } else {
      print_warning(text);
    }
  }
  return is_spoilt || (strict && !texts.empty());
}

Error nothing_to_write(bool stopped) {
  return {fmt::format("{}; there is nothing to write", why_incomplete(stopped))};
}

void print_problems(const RenderOutcome& outcome, bool stopped) {
  for (const std::string& problem : outcome.problems) print_warning(problem);
  const FilmAccumulator& film = outcome.film;
  if (outcome.complete) return;
  const auto [least, most, total] = sample_range(film);
  if (total == 0) {
    print_error(nothing_to_write(stopped));
  } else {
    print_error({fmt::format("{}; the image is incomplete, its pixels have {}", why_incomplete(stopped),
                             samples_text(least, most))});
  }
}

Expected<void> write_outputs(PreparedRender& prepared, const RenderOutcome& outcome,
                             const std::vector<std::string>& command_line) {
  const auto begin = Clock::now();
  // An image that was stopped is not worth the time.
  if (!outcome.complete) prepared.files.denoised_exr = prepared.files.denoised_png = {};
  const OutputFiles& files = prepared.files;
  Image image;
  OutputBatch batch;  // declared after the image that it writes, so that it is destroyed first
  RenderStatistics statistics;
  RenderedSamples rendered = rendered_samples(outcome);
  rendered.scene_warnings = prepared.scene.description.warnings.size();
  if (prepared.record.backend == Backend::kAuto) rendered.backends = backends_of(outcome);
  statistics.record = record_of_rendered(std::move(prepared.record), rendered);
  if (files.exr || files.png) {
    auto hash = std::async([&] { return outcome.film.hash(); });
    const MatteNames* mattes = statistics.record.scene.cryptomatte ? &prepared.scene.mattes : nullptr;
    image = image_of_film(outcome.film, statistics.record.film.width, statistics.record.film.height, mattes);
    image.metadata = record_metadata(statistics.record, hash.get(), rendered);
    if (mattes != nullptr)
      std::ranges::move(cryptomatte_metadata(*mattes), std::back_inserter(image.metadata));
    image.camera = camera_attributes(statistics.record.camera, statistics.record.film);
    add_images(image, statistics.record.film, files.exr, files.png, batch);
  }
  statistics.command_line = command_line;
  statistics.job = &prepared.job;
  statistics.workers = prepared.farm.workers;
  statistics.outcome = &outcome;
  statistics.warnings = prepared.scene.description.warnings;
  statistics.choice = prepared.scene.choice;
  statistics.needs = prepared.scene.summary.needs;
  statistics.left_out = prepared.scene.summary.left_out;
  // If the scene is shared with other renders, only its device scene is known.
  if (files.statistics && !prepared.scene.description.source.empty())
    statistics.inventory =
        scene_costs(prepared.scene.description, prepared.job.scene, prepared.job.device.isa, false);
  statistics.contradictory_shape = shape_of_first(prepared, outcome.film.flagged()[BAD_BOUNDARY]);
  statistics.build_seconds = prepared.scene.seconds;
  for (const OptionalPath& file : {files.exr, files.png, files.denoised_exr, files.denoised_png})
    if (file) statistics.files.push_back(*file);
  // This runs while the images are encoded.
  nlohmann::ordered_json json = files.statistics ? statistics_json(statistics) : nlohmann::ordered_json();
  batch.wait();
  if (files.statistics) {
    add_end(json, seconds_since(begin));
    add_statistics(json, *files.statistics, batch);
  }
  if (auto written = batch.finish(); !written) return written;
  // The image is safe before it is denoised.
  return !prepared.is_denoised_later && (files.denoised_exr || files.denoised_png)
             ? write_denoised(image, statistics.record.film, files)
             : Expected<void>();
}

RenderEnd finish_render(PreparedRender& prepared, const RenderOutcome& outcome,
                        const std::vector<std::string>& command_line, const std::string& name,
                        StoppedBy stopped) {
  Expected<void> written =
      sample_range(outcome.film).total == 0 ? fail("nothing was rendered") : make_folders(prepared.files);
  if (written) written = write_outputs(prepared, outcome, command_line);
  if (!written) print_error({fmt::format("{}: {}", name, written.error().message)});
  // Cancelling is a wish and no error; the caller tells what became of the render.
  if (stopped == StoppedBy::kCancel)
    for (const std::string& problem : outcome.problems) print_warning(problem);
  else
    print_problems(outcome, stopped == StoppedBy::kSignal);
  const bool is_wrong = print_flagged(prepared, outcome.film);
  if (!written) return {RenderEndKind::kFailed, written.error().message};
  if (!outcome.complete)
    return {RenderEndKind::kIncomplete,
            outcome.problems.empty() ? "it was stopped" : outcome.problems.front()};
  if (is_wrong) return {RenderEndKind::kIncomplete, "it has samples that are not as they should be"};
  return {};
}

}  // namespace penumbra
