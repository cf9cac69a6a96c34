#include "scheduler/report/report_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/diagnostic.h"
#include "scenes/scene_reader.h"
#include "scenes/settings.h"
#include "scheduler/render/option_checks.h"
#include "scheduler/render/render_option.h"
#include "worker/cli/help_text.h"
#include "worker/device.h"

namespace penumbra {
namespace {

/// Adds an option whose value is parsed by `parse`. If it is repeated, the values are appended.
template <typename Value, typename Parse>
Option* add_parsed(CommandLine& command, const std::string& name, std::vector<Value>& values, Parse parse,
                   const std::string& help) {
  return command
      .add_option_function(
          name,
          [&values, parse](const std::vector<std::string>& texts) -> Expected<void> {
            for (const std::string& text : texts) {
              auto value = parse(text);
              if (!value) return std::unexpected(value.error());
              values.push_back(std::move(*value));
            }
            return {};
          },
          help)
      ->repeatable();
}

void add_comparison_options(CommandLine& command, ReportOptions& options) {
  constexpr const char* kGroup = "Methods and budgets";
  add_parsed(
      command, "--integrator", options.methods, parse_method,
      "A method: path, path:nee=cv, polygon_cv:alpha=auto,vis_samples=4, LABEL=…; repeatable (default: "
      "the scene's)")
      ->type_name("[LABEL=]NAME[:KEY=VALUE,…]")
      ->group(kGroup);
  command.add_option("--sampler", options.samplers, "Sampler, as of `penumbra render`; repeatable")
      ->type_name("NAME")
      ->repeatable()
      ->check(one_of(sampler_names()).hidden())
      ->group(kGroup);
  command.add_option("--backend", options.backends, "native or opencl; repeatable (default: native)")
      ->type_name("NAME")
      ->repeatable()
      ->check(one_of({"native", "opencl"}).hidden())
      ->group(kGroup);
  const auto budgets = [&options](const std::string& text) -> Expected<void> {
    auto parsed = parse_budgets(text);
    if (!parsed) return std::unexpected(parsed.error());
    options.budgets = std::move(*parsed);
    return {};
  };
  auto* spp = command.add_option_function("--spp", budgets,
                                          "Samples per pixel, doubling from A to B (default: 1..64)");
  spp->type_name("A..B")->group(kGroup);
  command.add_option_function("--budgets", budgets, "The same as a list: 1,4,16")
      ->type_name("N,N,…")
      ->excludes(spp)
      ->group(kGroup);
  command
      .add_option("--seeds", options.seeds,
                  "Images of each budget, each with a seed of its own; 10 or more for biased methods")
      ->type_name("N")
      ->check(whole_number(1, 10000).hidden())
      ->capture_default_str()
      ->group(kGroup);
  command.add_option("--repeats", options.repeats, "Renders of each image; times are their medians")
      ->type_name("N")
      ->check(whole_number(1, 1000).hidden())
      ->capture_default_str()
      ->group(kGroup);
  command
      .add_option("--peer", options.peers,
                  "Images of other renderers, DIR/NAME/SECONDS-seconds.exr; SCENE= where there are several "
                  "scenes; repeatable")
      ->type_name("[SCENE=]DIR")
      ->repeatable()
      ->group(kGroup);
}

void add_reference_options(CommandLine& command, ReportOptions& options) {
  constexpr const char* kGroup = "Reference";
  command
      .add_option(
          "--reference", options.references,
          "Image file, or auto: two halves with seeds of their own, and with another integrator where "
          "there is one")
      ->type_name("[SCENE=]FILE|auto")
      ->repeatable()
      ->default_str("auto")
      ->group(kGroup);
  command
      .add_option("--second-reference", options.second_references,
                  "Another image, independent of the first: errors become free of the noise of both")
      ->type_name("[SCENE=]FILE")
      ->repeatable()
      ->group(kGroup);
  command
      .add_option("--reference-spp", options.reference_spp,
                  "Samples per pixel of both halves together (default: 50 times the largest budget or more)")
      ->type_name("N")
      ->check(whole_number(2, kMaxSamplesPerPixel).hidden())
      ->group(kGroup);
  add_parsed(command, "--reference-integrator", options.reference_methods, parse_method,
             "Integrator of both halves, written as for --integrator; given twice, of one each")
      ->type_name("NAME[:KEY=VALUE,…]")
      ->group(kGroup);
}

void add_presentation_options(CommandLine& command, ReportOptions& options) {
  constexpr const char* kGroup = "Report";
  add_parsed(command, "--target", options.targets, parse_target,
             "Find the time to this error: relmse=1e-3, mse=0.01, block_relmse=1e-3 (means of 4 x 4 pixels); "
             "repeatable (default: the smallest relMSE that all reach)")
      ->type_name("METRIC=VALUE")
      ->group(kGroup);
  command
      .add_option_function(
          "--crop-view",
          [&options](const std::string& text) -> Expected<void> {
            const auto choice = parse_crop_choice(text);
            if (!choice) return std::unexpected(choice.error());
            options.crop = *choice;
            return {};
          },
          "Part of the image that equal-time pictures show: error (where it is largest), centre, either with "
          ":SIZE, or X,Y,SIZE in film pixels (default: error)")
      ->type_name("PLACE")
      ->group(kGroup);
  command
      .add_option("--crop-time", options.crop_seconds,
                  "Seconds of the equal-time pictures (default: the longest that all methods have)")
      ->type_name("S")
      ->check(positive_number().hidden())
      ->group(kGroup);
  command.add_option("--exposure", options.exposure, "Exposure of the equal-time pictures, in stops")
      ->type_name("EV")
      ->check(number_between(-60, 60).hidden())
      ->capture_default_str()
      ->group(kGroup);
  command
      .add_option("--time", options.time,
                  "render: without start, scene transfer and compilation; total: with everything")
      ->type_name("render|total")
      ->check(one_of({"render", "total"}).hidden())
      ->capture_default_str()
      ->group(kGroup);
  command.add_option("--epsilon", options.epsilon, "Epsilon of relMSE")
      ->type_name("E")
      ->check(positive_number().hidden())
      ->capture_default_str()
      ->group(kGroup);
  command.add_flag("--no-plots", options.no_plots, "Tables and pictures only, without gnuplot")
      ->group(kGroup);
  command.add_flag("-q,--quiet", options.quiet, "Print warnings and errors only")->group(group::kGeneral);
}

void add_cell_options(CommandLine& command, RenderOptions& render) {
  constexpr const char* kGroup = "Rendering";
  for (const char* name : {"D", "set", "lenient", "dialect", "seed", "intersector"})
    add_render_option(command, render, name)->group(kGroup);
  command.option("--set")->description(
      "Override a parameter, for references too, as in --set film.width=256; repeatable");
  command.option("--seed")->description("Seed from which all others are made (default: 0)");
  command.add_option("--workers", render.workers, "Worker processes")
      ->type_name("N")
      ->check(whole_number(1, kMaxWorkers).hidden())
      ->capture_default_str()
      ->group(kGroup);
  for (const char* name : {"threads", "isa", "opencl-device"})
    add_render_option(command, render, name)->group(kGroup);
}

}  // namespace

void add_report_options(CommandLine& command, ReportOptions& options) {
  command.add_option("SCENE", options.scenes, "Scene files: " + list_names(scene_formats()))
      ->required()
      ->group(group::kInput);
  command.add_option("-o,--out", options.out, "Folder of the report; finished images stay in its cells/")
      ->required()
      ->type_name("DIR")
      ->group(group::kOutput);
  add_comparison_options(command, options);
  add_reference_options(command, options);
  add_presentation_options(command, options);
  add_cell_options(command, options.render);
}

std::optional<std::string> value_for_scene(const std::vector<std::string>& values, const std::string& scene,
                                           const std::vector<std::string>& scenes) {
  std::optional<std::string> named, unnamed;
  for (const std::string& value : values) {
    const std::size_t equals = value.find('=');
    const std::string name = value.substr(0, equals == std::string::npos ? 0 : equals);
    if (std::ranges::find(scenes, name) == scenes.end()) {
      unnamed = value;
    } else if (name == scene) {
      named = value.substr(equals + 1);
    }
  }
  return named ? named : unnamed;
}

}  // namespace penumbra
