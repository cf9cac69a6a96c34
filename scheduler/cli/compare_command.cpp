// `penumbra compare A B`: measures the difference of A from the reference B.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "kernels/host/atomic_file.h"
#include "scheduler/cli/commands.h"
#include "scheduler/cli/compare_shot.h"
#include "scheduler/files/output_check.h"
#include "scheduler/image/compare.h"
#include "scheduler/image/image_files.h"
#include "scheduler/image/metrics/color_bar.h"
#include "scheduler/image/picture.h"
#include "scheduler/render/option_checks.h"
#include "worker/cli/help_text.h"

namespace penumbra {
namespace {

struct CompareCommandOptions {
  std::vector<std::string> others;  ///< the images after the first, then the reference
  std::string image, reference, second_reference, variance, reference_variance;
  CompareOptions compare;
  std::string json;  ///< file name, or - for stdout
  std::string heatmap, map = "relmse";
  std::string plot;  ///< of shots: name of the plot's files without extension
  std::optional<MapRange> range;
  bool logarithmic = false;
  std::vector<CompareLimit> limits;
  bool must_agree = false;
  bool display = false;  ///< compares what the images look like as 8-bit sRGB
};

/// "LOW,HIGH".
std::optional<MapRange> parse_range(const std::string& text) {
  MapRange range;
  int end = -1;
  if (std::sscanf(text.c_str(), "%lf,%lf%n", &range.low, &range.high, &end) != 2) return std::nullopt;
  if (end != int(text.size()) || !std::isfinite(range.low) || !std::isfinite(range.high)) return std::nullopt;
  if (range.low >= range.high) return std::nullopt;
  return range;
}

bool is_png(const std::filesystem::path& path) { return path.extension() == ".png"; }

/// Checks before the work that all outputs can be written and overwrite no input: none of the images and none
/// of the options' other files.
Expected<void> check_files(const CompareCommandOptions& options, const std::vector<std::string>& images) {
  std::vector<std::filesystem::path> inputs(images.begin(), images.end());
  for (const auto& file :
       {options.reference, options.second_reference, options.variance, options.reference_variance})
    if (!file.empty()) inputs.emplace_back(file);
  std::vector<std::filesystem::path> outputs;
  if (!options.heatmap.empty()) {
    if (!is_png(options.heatmap) && std::filesystem::path(options.heatmap).extension() != ".exr") {
      return fail(options.heatmap + ": a heat map is a .png or an .exr");
    }
    outputs.push_back(options.heatmap);
  }
  if (options.logarithmic && options.range && options.range->low <= 0) {
    return fail(
        fmt::format("--log-colors needs a range above 0, and --range begins at {:g}", options.range->low));
  }
  if (!options.json.empty() && options.json != "-") outputs.push_back(options.json);
  return check_outputs(outputs, inputs);
}

/// The images of the command line, in memory.
struct LoadedImages {
  std::optional<Image> image, reference, second_reference, variance, reference_variance;
};

Expected<LoadedImages> load(const CompareCommandOptions& options) {
  LoadedImages images;
  const std::pair<const std::string&, std::optional<Image>&> files[] = {
      {options.image, images.image},
      {options.reference, images.reference},
      {options.second_reference, images.second_reference},
      {options.variance, images.variance},
      {options.reference_variance, images.reference_variance}};
  for (const auto& [file, image] : files) {
    if (file.empty()) continue;
    auto read = read_image(file);
    if (!read) return std::unexpected(read.error());
    image = std::move(*read);
  }
  if (!options.display) return images;
  for (const auto& [file, image] : {files[0], files[1], files[2]}) {
    if (file.empty()) continue;
    auto display = display_image(*image);
    if (!display) return fail(file + ": " + display.error().message);
    image = std::move(*display);
  }
  return images;
}

Expected<Comparison> run_comparison(const CompareCommandOptions& options) {
  const auto images = load(options);
  if (!images) return std::unexpected(images.error());
  const auto pointer = [](const std::optional<Image>& image) { return image ? &*image : nullptr; };
  auto comparison = compare_images({.image = *images->image,
                                    .reference = *images->reference,
                                    .second_reference = pointer(images->second_reference),
                                    .variance = pointer(images->variance),
                                    .reference_variance = pointer(images->reference_variance)},
                                   options.compare);
  if (!comparison) {
    return fail(fmt::format("cannot compare {} with {}: {}", options.image, options.reference,
                            comparison.error().message));
  }
  return comparison;
}

struct WrittenMap {
  std::string file, name;
  MapRange range;
};

struct HeatMap {
  Image image;
  MapRange range;
};

Expected<HeatMap> make_heat_map(const CompareCommandOptions& options, const Comparison& comparison) {
  const auto map = error_map(comparison, options.map);
  if (!map) return std::unexpected(map.error());
  MapRange range = options.range.value_or(default_range(*map));
  if (options.logarithmic && options.range) {
    range.logarithmic = true;
  } else if (options.logarithmic) {
    range = range.on_logarithmic_scale();
  }
  return HeatMap{heat_map_image(*map, range), range};
}

Expected<WrittenMap> write_heat_map(const CompareCommandOptions& options, const HeatMap& map) {
  // An EXR holds the values themselves, and the range as metadata.
  const auto bytes = is_png(options.heatmap) ? encode_png(with_color_bar(map.image, map.range, options.map))
                                             : encode_exr(map.image);
  if (!bytes) return std::unexpected(bytes.error());
  if (const auto written = write_output(options.heatmap, *bytes); !written)
    return std::unexpected(written.error());
  return WrittenMap{options.heatmap, options.map, map.range};
}

struct CheckedLimit {
  CompareLimit limit;
  double value = 0;
  bool exceeded = false;  ///< NaN counts as exceeded
};

Expected<std::vector<CheckedLimit>> check_limits(const CompareCommandOptions& options,
                                                 const Comparison& comparison) {
  std::vector<CheckedLimit> checked;
  for (const CompareLimit& limit : options.limits) {
    const auto value = limited_value(comparison, limit.metric);
    if (!value) return std::unexpected(value.error());
    checked.push_back({limit, *value, !(*value <= limit.value)});
  }
  if (options.must_agree && !comparison.z_test) {
    return fail("no z-test: " + comparison.z_test_left_out + " (see --variance)");
  }
  return checked;
}

/// Whether all limits are met; prints those that are not.
bool passes(const CompareCommandOptions& options, const Comparison& comparison,
            const std::vector<CheckedLimit>& limits) {
  bool good = true;
  for (const CheckedLimit& checked : limits) {
    if (!checked.exceeded) continue;
    good = false;
    print_error({fmt::format("{} {:.6g} is above the limit {:.6g}", checked.limit.metric, checked.value,
                             checked.limit.value)});
  }
  if (options.must_agree && comparison.verdict != Verdict::kAgree) {
    good = false;
    print_error({fmt::format("{}: {}",
                             comparison.verdict == Verdict::kDiffer
                                 ? "the images differ by more than their noise"
                                 : "whether the images differ by more than their noise is inconclusive",
                             comparison.verdict_reason)});
  }
  const std::uint64_t bad_pixels = comparison.pair.image_non_finite + comparison.pair.reference_non_finite;
  if ((!limits.empty() || options.must_agree) && bad_pixels > 0) {
    good = false;
    print_error(
        {fmt::format("pixels that are NaN or infinite: {} of {}, {} of {}", comparison.pair.image_non_finite,
                     options.image, comparison.pair.reference_non_finite, options.reference)});
  }
  return good;
}

nlohmann::ordered_json report_json(const CompareCommandOptions& options, const Comparison& comparison,
                                   const std::vector<CheckedLimit>& limits,
                                   const std::optional<WrittenMap>& map, bool passed) {
  nlohmann::ordered_json json = {{"image", options.image}, {"reference", options.reference}};
  json.update(comparison_json(comparison));
  json["limits"] = nlohmann::ordered_json::array();
  for (const CheckedLimit& checked : limits) {
    json["limits"].push_back({{"metric", checked.limit.metric},
                              {"limit", checked.limit.value},
                              {"value", std::isfinite(checked.value) ? nlohmann::ordered_json(checked.value)
                                                                     : nlohmann::ordered_json(nullptr)},
                              {"exceeded", checked.exceeded}});
  }
  json["passed"] = passed;
  if (map)
    json["heatmap"] = {{"file", map->file},
                       {"map", map->name},
                       {"low", map->range.low},
                       {"high", map->range.high},
                       {"logarithmic", map->range.logarithmic}};
  return json;
}

ExitCode bad_input(const Error& error) { return print_error(error), kBadInput; }

struct Compared {
  ExitCode code = kAllDone;
  nlohmann::ordered_json json = {};  ///< null if the images could not be compared
};

/// Compares one image, and prints the table unless JSON goes to stdout.
Compared compare_one(const CompareCommandOptions& options) {
  const auto bad_input = [](const Error& error) { return print_error(error), Compared{kBadInput}; };
  const auto comparison = run_comparison(options);
  if (!comparison) return bad_input(comparison.error());
  const auto limits = check_limits(options, *comparison);
  if (!limits) return bad_input(limits.error());
  std::optional<WrittenMap> map;
  if (!options.heatmap.empty()) {
    const auto made = make_heat_map(options, *comparison);
    if (!made) return bad_input(made.error());
    auto written = write_heat_map(options, *made);
    if (!written) return print_error(written.error()), Compared{kIncomplete};
    map = std::move(*written);
  }
  if (options.json != "-") {
    print_answer(comparison_text(*comparison));
    if (map)
      print_answer(fmt::format("{}: {} from {:.6g} (dark) to {:.6g} (yellow){}\n", map->file, map->name,
                               map->range.low, map->range.high,
                               map->range.logarithmic ? ", logarithmic" : ""));
  }
  const bool passed = passes(options, *comparison, *limits);
  return {passed ? kAllDone : kIncomplete, report_json(options, *comparison, *limits, map, passed)};
}

ExitCode write_json(const std::string& file, const nlohmann::ordered_json& json) {
  const std::string text = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  if (file == "-") return print_answer(text), kAllDone;
  if (const auto written = write_output(file, bytes_of(text)); !written)
    return print_error(written.error()), kIncomplete;
  return kAllDone;
}

/// Frames of shots have a line each.
ExitCode compare_frames(const CompareCommandOptions& options, const FrameFiles& images,
                        const FrameFiles& reference) {
  ExitCode code = kAllDone;
  const auto check = [&](const std::string& image, const Comparison& comparison) {
    const auto limits = check_limits(options, comparison);
    if (!limits) {
      print_error({fmt::format("{}: {}", image, limits.error().message)});
      code = std::max(code, kBadInput);
    } else if (!passes(options, comparison, *limits)) {
      print_error({fmt::format("{} is not within the limits", image)});
      code = std::max(code, kIncomplete);
    }
  };
  const std::vector<FrameError> frames = compare_shots(images, reference, options.compare, check);
  if (frames.empty())
    return bad_input({fmt::format("there are no frames {} or {}", options.image, options.others.back())});
  for (const FrameError& frame : frames)
    if (!frame.error.empty()) {
      print_error({fmt::format("frame {}: {}", frame.frame, frame.error)});
      code = kBadInput;
    }
  if (options.json != "-") print_answer(shot_text(frames));
  if (!options.plot.empty())
    if (const auto drawn = plot_shot(frames, options.plot); !drawn) {
      print_error(drawn.error());
      code = std::max(code, kIncomplete);
    }
  if (options.json.empty()) return code;
  nlohmann::ordered_json json = {{"image", options.image}, {"reference", options.others.back()}};
  json.update(shot_json(frames));
  return std::max(code, write_json(options.json, json));
}

/// The shots, if both names are of shots.
std::optional<std::pair<FrameFiles, FrameFiles>> shots_of(const CompareCommandOptions& options) {
  if (options.others.size() != 1) return std::nullopt;
  const auto images = FrameFiles::unless_file(options.image);
  const auto reference = FrameFiles::unless_file(options.others.back());
  if (!images || !reference) return std::nullopt;
  return std::pair(*images, *reference);
}

/// Several images have a table each, and one list in JSON.
ExitCode compare(CompareCommandOptions options) {
  const auto shots = shots_of(options);
  for (const auto& [name, is_given] : {std::pair("--heatmap", !options.heatmap.empty()),
                                       {"--variance", !options.variance.empty()},
                                       {"--reference-variance", !options.reference_variance.empty()},
                                       {"--second-reference", !options.second_reference.empty()},
                                       {"--ldr", options.display}})
    if (shots && is_given) return bad_input({fmt::format("{} is of images, and these are shots", name)});
  if (!shots && !options.plot.empty())
    return bad_input({"--plot is of shots: two names with a field for the frame, such as a.####.exr"});
  if (shots) {
    if (const auto checked = check_files(options, {}); !checked) return bad_input(checked.error());
    return compare_frames(options, shots->first, shots->second);
  }
  std::vector<std::string> images = options.others;
  options.reference = images.back();
  images.back() = options.image;
  std::ranges::rotate(images, images.end() - 1);
  const bool several = images.size() > 1;
  for (const auto& [name, value] :
       {std::pair("--heatmap", &options.heatmap), {"--variance", &options.variance}})
    if (several && !value->empty())
      return bad_input({fmt::format("{} is of one image, and here are {}", name, images.size())});
  if (const auto checked = check_files(options, images); !checked) return bad_input(checked.error());
  ExitCode code = kAllDone;
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const std::string& image : images) {
    options.image = image;
    if (several && options.json != "-")
      print_answer(fmt::format("{}{} against {}\n", all.empty() ? "" : "\n", image, options.reference));
    Compared compared = compare_one(options);
    code = std::max(code, compared.code);
    if (!compared.json.is_null()) all.push_back(std::move(compared.json));
  }
  if (options.json.empty() || all.empty()) return code;
  return std::max(code, write_json(options.json, several ? all : all.front()));
}

void add_metric_options(CommandLine& command, CompareCommandOptions& options) {
  constexpr const char* kGroup = "Metrics";
  command
      .add_option("--layer", options.compare.layer, "Layer or channel of an EXR: albedo, depth, samples.Y…")
      ->type_name("NAME")
      ->default_str("beauty")
      ->group(kGroup);
  command
      .add_option("--second-reference", options.second_reference,
                  "Another reference, independent of B: squared errors become free of the noise of both")
      ->type_name("FILE")
      ->group(kGroup);
  command
      .add_flag("--ldr", options.display,
                "Compare what a PNG shows, clamped and in 8-bit sRGB: for an EXR against a PNG")
      ->group(kGroup);
  command.add_option("--epsilon", options.compare.epsilon, "Epsilon of relMSE, MAPE and SMAPE")
      ->check(number_from_zero())
      ->capture_default_str()
      ->type_name("E")
      ->group(kGroup);
  command
      .add_choice(
          "--flip",
          {{"auto", int(FlipKind::kAuto)},
           {"ldr", int(FlipKind::kDisplay)},
           {"hdr", int(FlipKind::kRadiance)},
           {"none", int(FlipKind::kNone)}},
          [&options](int kind) { options.compare.flip = FlipKind(kind); },
          "auto (ldr for PNG, hdr for EXR), ldr, hdr, none")
      ->type_name("KIND")
      ->default_str("auto")
      ->group(kGroup);
  command.add_option("--ppd", options.compare.pixels_per_degree, "Pixels per degree of the observer of FLIP")
      ->check(number_between(1, 10000).hidden())
      ->type_name("P")
      ->default_str("67.02")
      ->group(kGroup);
}

void add_z_options(CommandLine& command, CompareCommandOptions& options) {
  constexpr const char* kGroup = "Noise";
  command.add_option("--variance", options.variance, "Variance of A's values (default: A's layer variance)")
      ->type_name("FILE")
      ->group(kGroup);
  command
      .add_option("--reference-variance", options.reference_variance,
                  "Variance of B's values (default: B's layer variance; else B counts as exact)")
      ->type_name("FILE")
      ->group(kGroup);
  command
      .add_option("--significance", options.compare.z_test.significance,
                  "Chance that images which differ by noise alone fail the z-test")
      ->check(number_between(1e-12, 0.5).hidden())
      ->capture_default_str()
      ->type_name("P")
      ->group(kGroup);
  command
      .add_flag("--exact-reference", options.compare.exact_reference,
                "B has no noise, if it has no variances (default: then nothing is called a difference)")
      ->group(kGroup);
  command.add_option("--block", options.compare.z_test.block, "Side of the z-test's blocks in pixels")
      ->check(whole_number(1, 65536).hidden())
      ->capture_default_str()
      ->type_name("N")
      ->group(kGroup);
}

void add_output_options(CommandLine& command, CompareCommandOptions& options) {
  constexpr const char* kGroup = group::kOutput;
  command
      .add_option("--json", options.json, "Write JSON; without FILE, or as -, to stdout instead of the table")
      ->expected(0, 1)
      ->default_str("-")
      ->type_name("FILE")
      ->group(kGroup);
  command
      .add_option("--plot", options.plot,
                  "Of shots, plot the errors over the frames: NAME.svg, NAME.png, NAME.gp")
      ->type_name("NAME")
      ->group(kGroup);
  const auto heatmap = command
                           .add_option("--heatmap", options.heatmap,
                                       "Picture of the errors (.png with a colour bar below, .exr)")
                           ->type_name("FILE")
                           ->group(kGroup);
  command.add_option("--map", options.map, "Error shown by the heat map: relmse, abs, flip, z")
      ->check(one_of({"relmse", "abs", "flip", "z"}).hidden())
      ->capture_default_str()
      ->type_name("MAP")
      ->needs(heatmap)
      ->group(kGroup);
  command
      .add_option_function(
          "--range",
          [&options](const std::string& text) -> Expected<void> {
            options.range = parse_range(text);
            if (!options.range) return fail("'" + text + "' is not LOW,HIGH with LOW < HIGH");
            return {};
          },
          "Errors that the heat map shows darkest and brightest (default: 0,1 for flip, 0,5 for z, else 0 "
          "to the 99th percentile)")
      ->type_name("LOW,HIGH")
      ->needs(heatmap)
      ->group(kGroup);
  command
      .add_flag("--log-colors", options.logarithmic,
                "Logarithmic scale of the colours (default: linear); LOW is a ten-thousandth of HIGH")
      ->needs(heatmap)
      ->group(kGroup);
}

void add_limit_options(CommandLine& command, CompareCommandOptions& options) {
  constexpr const char* kGroup = "Limits";
  command
      .add_option_function(
          "--fail-above",
          [&options](const std::vector<std::string>& texts) -> Expected<void> {
            for (const std::string& text : texts) {
              const auto limit = parse_limit(text);
              if (!limit) return std::unexpected(limit.error());
              options.limits.push_back(*limit);
            }
            return {};
          },
          fmt::format(
              "Exit code 1 if the metric is larger, or a pixel is NaN or infinite; repeatable. METRIC: {}",
              fmt::join(limit_metrics(), ", ")))
      ->type_name("METRIC=VALUE")
      ->repeatable()
      ->group(kGroup);
  command
      .add_option_function(
          "--tolerance",
          [&options](double value) {
            options.limits.push_back({"relmse", value});
            return Expected<void>();
          },
          "The same as --fail-above relmse=E")
      ->type_name("E")
      ->check(number_from_zero())
      ->group(kGroup);
  command
      .add_flag("--z-test", options.must_agree,
                "Exit code 1 unless the verdict is that the images agree within their noise")
      ->group(kGroup);
}

}  // namespace

void add_compare_command(CommandLine& app, Command& chosen) {
  CommandLine* command = app.add_command("compare", "Measure the error of an image against a reference");
  const auto options = std::make_shared<CompareCommandOptions>();
  command->add_option("A", options->image, "Image to measure")->check(some_text())->required();
  command
      ->add_option("B", options->others,
                   "Reference, of the same size. With more files the last is it, and each of the others is "
                   "compared with it")
      ->check(some_text())
      ->required();
  add_metric_options(*command, *options);
  add_z_options(*command, *options);
  add_output_options(*command, *options);
  add_limit_options(*command, *options);
  for (const char* linear :
       {"--layer", "--variance", "--reference-variance", "--exact-reference", "--z-test"})
    command->option("--ldr")->excludes(command->option(linear));
  command->footer(
      "Reads any format that OpenImageIO reads; of an EXR the channels R, G, B. Values are compared as "
      "stored; an EXR and a PNG with --ldr. The table says what each metric is. NaN and infinite pixels are "
      "counted and left out.\n\n"
      "The verdict comes from the variances in Penumbra's EXR files. Images differ if single values, blocks "
      "or "
      "the whole image differ by more than noise at the significance. They agree if nothing does and a "
      "difference of 10% of the mean would be found. It is inconclusive without variances, with fewer than 4 "
      "samples per pixel, and for denoised images and photon mapping.\n\n"
      "Of two shots ('a.####.exr') there is a line for each frame, with flicker: the squared error of the "
      "change from the "
      "frame before, along the layer motion of the reference, over the reference's square.\n\n"
      "Exit code: 0 compared, and within the limits; 1 a limit is exceeded, or with --z-test the images do "
      "not "
      "agree or it is inconclusive; 2 bad usage or bad input, with --z-test also no variances.\n\n"
      "Examples:\n"
      "  penumbra compare cornell.exr reference.exr\n"
      "  penumbra compare cornell.exr reference.exr --json | jq .relmse\n"
      "  penumbra compare cornell.exr reference.exr --heatmap where.png --map flip\n"
      "  penumbra compare spp*.exr reference.exr\n"
      "  penumbra compare 'a.####.exr' 'reference.####.exr' --plot errors\n"
      "  penumbra compare cornell.exr half1.exr --second-reference half2.exr\n"
      "  penumbra compare a.exr b.exr --z-test && echo the same up to noise\n"
      "  penumbra compare a.exr b.exr --fail-above relmse=1e-3 --fail-above max=0.5 && echo good enough");
  command->callback([options, &chosen] { chosen = [options] { return compare(*options); }; });
}

}  // namespace penumbra
