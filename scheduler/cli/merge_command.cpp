// `penumbra merge`: merges images of the same scene that were rendered with other seeds.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "kernels/host/text.h"
#include "scenes/settings.h"
#include "scheduler/cli/commands.h"
#include "scheduler/files/json_number.h"
#include "scheduler/files/output_batch.h"
#include "scheduler/files/output_check.h"
#include "scheduler/record/merged_image.h"
#include "scheduler/render/option_checks.h"
#include "scheduler/run/output_files.h"
#include "scheduler/run/render_outputs.h"
#include "worker/cli/help_text.h"

namespace penumbra {
namespace {

struct MergeCommandOptions {
  std::vector<std::string> images;
  std::string out;
  bool no_statistics = false;
};

Expected<std::vector<MergeSource>> read_sources(const std::vector<std::string>& files) {
  std::vector<MergeSource> sources;
  for (const std::string& file : files) {
    auto header = read_image_header(file);
    if (!header) return std::unexpected(header.error());
    auto source = merge_source(file, std::move(*header));
    if (!source) return std::unexpected(source.error());
    sources.push_back(std::move(*source));
  }
  if (const auto checked = check_sources(sources); !checked) return std::unexpected(checked.error());
  return sources;
}

/// Reads one image after the other, so that only one is in memory.
Expected<Image> merge_images(const std::vector<MergeSource>& sources) {
  ImageMerge merge(sources);
  for (const MergeSource& source : sources) {
    const auto image = read_image(source.file);
    if (!image) return std::unexpected(image.error());
    if (const auto added = merge.add(source, *image); !added) return std::unexpected(added.error());
  }
  for (const std::string& remark : merge.remarks()) print_warning(remark);
  return merge.image();
}

/// The sources' file format, as far as they agree.
Film format_of(const Image& image) {
  RenderSettings settings;
  for (const char* key : {"film.compression", "film.component_format"})
    if (const std::string value = metadata_text(image, std::string("penumbra:") + key); !value.empty())
      (void)apply_setting(settings, key, value);  // what a later version writes is not needed
  return settings.film;
}

struct MergedSamples {
  std::uint64_t least = 0, most = 0, total = 0;
  double relative_error = 0;  ///< as FilmAccumulator::relative_error
};

MergedSamples samples_of(const Image& image) {
  MergedSamples samples{.least = UINT64_MAX};
  double sum = 0;
  std::size_t terms = 0;
  const std::size_t counts = *image.channel("samples.Y");
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    const float* values = &image.values[pixel * image.channels.size()];
    const auto count = std::uint64_t(values[counts]);
    samples.least = std::min(samples.least, count);
    samples.most = std::max(samples.most, count);
    samples.total += count;
    if (count < 2) continue;
    for (const char* letter : {"R", "G", "B"}) {
      const double mean = values[*image.channel(letter)];
      sum += values[*image.channel(std::string("variance.") + letter)] / (mean * mean + 0.01);
      ++terms;
    }
  }
  samples.relative_error = std::sqrt(sum / double(terms));
  return samples;
}

nlohmann::ordered_json statistics_of(const Image& image, const std::vector<MergeSource>& sources,
                                     const MergedSamples& samples, const OutputFiles& files,
                                     const std::vector<std::string>& command_line) {
  using Json = nlohmann::ordered_json;
  Json merged = Json::array(), names = Json::array(), settings;
  for (const MergeSource& source : sources) {
    std::vector<std::uint32_t> seeds;
    for (const MergedRender& render : source.renders) seeds.push_back(render.seed);
    merged.push_back({{"file", source.file.string()},
                      {"seeds", seeds},
                      {"spp", std::uint64_t(source.weight)},
                      {"complete", !source.header.attribute("penumbra:incomplete")}});
  }
  for (const auto& file : {files.exr, files.png})
    if (file) names.push_back(file->string());
  for (const auto& [name, value] : image.metadata)
    if (name.starts_with("penumbra:") && name != "penumbra:merged")
      settings[name.substr(name.find(':') + 1)] = std::visit([](const auto& v) { return Json(v); }, value);
  const PixelWindow& crop = image.data;
  return {{"complete", !image.attribute("penumbra:incomplete")},
          {"merged", merged},
          {"files", names},
          {"command_line", command_line},
          {"film",
           {{"width", image.display.width},
            {"height", image.display.height},
            {"crop", {crop.x, crop.y, crop.x + crop.width, crop.y + crop.height}}}},
          {"settings", settings},
          {"samples",
           {{"total", samples.total}, {"least_per_pixel", samples.least}, {"most_per_pixel", samples.most}}},
          {"relative_error", json_number(samples.relative_error)}};
}

ExitCode merge(const MergeCommandOptions& options, const std::vector<std::string>& command_line) {
  auto files = image_files(options.out);
  if (!files) return print_error(files.error()), kBadInput;
  if (files->exr && !options.no_statistics)
    files->statistics = std::filesystem::path(*files->exr).replace_extension(".json");
  const std::vector<std::filesystem::path> inputs(options.images.begin(), options.images.end());
  if (const auto checked = check_outputs(files->all(), inputs); !checked)
    return print_error(checked.error()), kBadInput;
  const auto sources = read_sources(options.images);
  if (!sources) return print_error(sources.error()), kBadInput;
  const auto image = merge_images(*sources);
  if (!image) return print_error(image.error()), kBadInput;
  const MergedSamples samples = samples_of(*image);
  if (const auto made = make_folders(*files); !made) return print_error(made.error()), kIncomplete;
  OutputBatch batch;
  add_images(*image, format_of(*image), files->exr, files->png, batch);
  if (files->statistics)
    add_statistics(statistics_of(*image, *sources, samples, *files, command_line), *files->statistics, batch);
  if (const auto done = batch.finish(); !done) return print_error(done.error()), kIncomplete;
  std::vector<std::string> names;
  for (const auto& file : files->all()) names.push_back(file.string());
  print_remark(fmt::format("wrote {}: {} of seeds {}, {} samples per pixel\n", fmt::join(names, ", "),
                           counted(sources->size(), "image"), seeds_text(all_renders(*sources)),
                           samples.least == samples.most
                               ? fmt::format("{}", samples.most)
                               : fmt::format("{} to {}", samples.least, samples.most)));
  return kAllDone;
}

}  // namespace

void add_merge_command(CommandLine& app, const std::vector<std::string>& command_line, Command& chosen) {
  CommandLine* command = app.add_command("merge", "Merge renders of a scene with other seeds into one image");
  const auto options = std::make_shared<MergeCommandOptions>();
  command->add_option("IMAGE", options->images, "EXR files of `penumbra render`, two or more")
      ->check(some_text())
      ->type_name("FILE")
      ->required();
  command->add_option("-o,--out", options->out, "x.exr writes x.exr, x.png and x.json, x.png only that")
      ->type_name("FILE")
      ->required()
      ->group(group::kOutput);
  command->add_flag("--no-statistics", options->no_statistics, "Write no JSON")->group(group::kOutput);
  command->footer(
      "The image has the mean, variance and number of all samples, layer by layer, as if one render had "
      "them; "
      "the order of the files does not matter. The renders must be of the same scene, settings and film, "
      "with "
      "other seeds; numbers of samples may differ, and incomplete images are taken, too. A merged image can "
      "be "
      "merged again.\n\n"
      "Examples:\n"
      "  penumbra render scene.xml --seed 1 -o a.exr\n"
      "  penumbra render scene.xml --seed 2 -o b.exr\n"
      "  penumbra merge a.exr b.exr -o merged.exr");
  command->callback([options, &command_line, &chosen] {
    chosen = [options, &command_line] { return merge(*options, command_line); };
  });
}

}  // namespace penumbra
