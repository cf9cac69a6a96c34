#include "scheduler/cli/report_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/diagnostic.h"
#include "scenes/scene_reader.h"
#include "scenes/settings.h"
#include "scheduler/cli/help_text.h"
#include "scheduler/cli/option_checks.h"
#include "worker/device.h"

namespace penumbra {
namespace {

/// Adds an option whose value is parsed by `parse`. If it is repeated, the values are appended.
template <typename Value, typename Parse>
CLI::Option* add_parsed(CLI::App& command, const std::string& name, std::vector<Value>& values, Parse parse,
                        const std::string& help) {
  return command
      .add_option_function<std::vector<std::string>>(
          name,
          [&values, parse, name](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) {
              auto value = parse(text);
              if (!value) throw CLI::ValidationError(name, value.error().message);
              values.push_back(std::move(*value));
            }
          },
          help)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_comparison_options(CLI::App& command, ReportOptions& options) {
  constexpr const char* kGroup = "Methods and budgets";
  add_parsed(
      command, "--integrator", options.methods, parse_method,
      "A method: path, path:nee=cv, polygon_cv:alpha=auto,vis_samples=4, LABEL=…; repeatable (default: "
      "the scene's)")
      ->type_name("[LABEL=]NAME[:KEY=VALUE,…]")
      ->group(kGroup);
  command.add_option("--sampler", options.samplers, "Sampler, as of `penumbra render`; repeatable")
      ->type_name("NAME")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->check(CLI::IsMember(sampler_names()).description(""))
      ->group(kGroup);
  command.add_option("--backend", options.backends, "native or opencl; repeatable (default: native)")
      ->type_name("NAME")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->check(CLI::IsMember({"native", "opencl"}).description(""))
      ->group(kGroup);
  const auto budgets = [&options](const std::string& name) {
    return [&options, name](const std::string& text) {
      auto parsed = parse_budgets(text);
      if (!parsed) throw CLI::ValidationError(name, parsed.error().message);
      options.budgets = std::move(*parsed);
    };
  };
  auto* spp = command.add_option_function<std::string>(
      "--spp", budgets("--spp"), "Samples per pixel, doubling from A to B (default: 1..64)");
  spp->type_name("A..B")->group(kGroup);
  command.add_option_function<std::string>("--budgets", budgets("--budgets"), "The same as a list: 1,4,16")
      ->type_name("N,N,…")
      ->excludes(spp)
      ->group(kGroup);
  command
      .add_option("--seeds", options.seeds,
                  "Images of each budget, each with a seed of its own; 10 or more for biased methods")
      ->type_name("N")
      ->check(whole_number(1, 10000).description(""))
      ->capture_default_str()
      ->group(kGroup);
  command.add_option("--repeats", options.repeats, "Renders of each image; times are their medians")
      ->type_name("N")
      ->check(whole_number(1, 1000).description(""))
      ->capture_default_str()
      ->group(kGroup);
  command
      .add_option("--peer", options.peers,
                  "Images of other renderers, DIR/NAME/SECONDS-seconds.exr; SCENE= where there are several "
                  "scenes; repeatable")
      ->type_name("[SCENE=]DIR")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->group(kGroup);
}

void add_reference_options(CLI::App& command, ReportOptions& options) {
  constexpr const char* kGroup = "Reference";
  command
      .add_option(
          "--reference", options.references,
          "Image file, or auto: two halves with seeds of their own, and with another integrator where "
          "there is one")
      ->type_name("[SCENE=]FILE|auto")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->default_str("auto")
      ->group(kGroup);
  command
      .add_option("--second-reference", options.second_references,
                  "Another image, independent of the first: errors become free of the noise of both")
      ->type_name("[SCENE=]FILE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->group(kGroup);
  command
      .add_option("--reference-spp", options.reference_spp,
                  "Samples per pixel of both halves together (default: 50 times the largest budget or more)")
      ->type_name("N")
      ->check(whole_number(2, kMaxSamplesPerPixel).description(""))
      ->group(kGroup);
  add_parsed(command, "--reference-integrator", options.reference_methods, parse_method,
             "Integrator of both halves, written as for --integrator; given twice, of one each")
      ->type_name("NAME[:KEY=VALUE,…]")
      ->group(kGroup);
}

void add_presentation_options(CLI::App& command, ReportOptions& options) {
  constexpr const char* kGroup = "Report";
  add_parsed(command, "--target", options.targets, parse_target,
             "Find the time to this error: relmse=1e-3, mse=0.01, block_relmse=1e-3 (means of 4 x 4 pixels); "
             "repeatable (default: the smallest relMSE that all reach)")
      ->type_name("METRIC=VALUE")
      ->group(kGroup);
  command
      .add_option_function<std::string>(
          "--crop-view",
          [&options](const std::string& text) {
            const auto choice = parse_crop_choice(text);
            if (!choice) throw CLI::ValidationError("--crop-view", choice.error().message);
            options.crop = *choice;
          },
          "Part of the image that equal-time pictures show: error (where it is largest), centre, either with "
          ":SIZE, or X,Y,SIZE in film pixels (default: error)")
      ->type_name("PLACE")
      ->group(kGroup);
  command
      .add_option("--crop-time", options.crop_seconds,
                  "Seconds of the equal-time pictures (default: the longest that all methods have)")
      ->type_name("S")
      ->check(positive_number().description(""))
      ->group(kGroup);
  command.add_option("--exposure", options.exposure, "Exposure of the equal-time pictures, in stops")
      ->type_name("EV")
      ->check(number_between(-60, 60).description(""))
      ->capture_default_str()
      ->group(kGroup);
  command
      .add_option("--time", options.time,
                  "render: without start, scene transfer and compilation; total: with everything")
      ->type_name("render|total")
      ->check(CLI::IsMember({"render", "total"}).description(""))
      ->capture_default_str()
      ->group(kGroup);
  command.add_option("--epsilon", options.epsilon, "Epsilon of relMSE")
      ->type_name("E")
      ->check(positive_number().description(""))
      ->capture_default_str()
      ->group(kGroup);
  command.add_flag("--no-plots", options.no_plots, "Tables and pictures only, without gnuplot")
      ->group(kGroup);
  command.add_flag("-q,--quiet", options.quiet, "Print warnings and errors only")->group(group::kGeneral);
}

void add_cell_options(CLI::App& command, RenderOptions& render) {
  constexpr const char* kGroup = "Rendering";
  SceneOptions& scene = render.scene;
  command.add_option("-D", scene.defines, "Fill $NAME of the scene files; repeatable")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false)
      ->check(assignment())
      ->group(kGroup);
  command
      .add_option("--set", scene.settings,
                  "Override a parameter, for references too, as in --set film.width=256; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->check(assignment())
      ->group(kGroup);
  command
      .add_flag("--lenient", scene.lenient,
                "Warn of what is unknown, missing or out of range, and render the rest")
      ->group(kGroup);
  command
      .add_option("--dialect", scene.dialect,
                  "Of Nori scenes: nori or nori-eth (default: told from the file)")
      ->type_name("NAME")
      ->check(CLI::IsMember({"nori", "nori-eth"}).description(""))
      ->group(kGroup);
  command.add_option("--seed", scene.seed, "Seed from which all others are made (default: 0)")
      ->type_name("S")
      ->check(whole_number(0, kMaxSeed).description(""))
      ->group(kGroup);
  command.add_option("--intersector", scene.intersector, "auto, portable, embree")
      ->type_name("NAME")
      ->check(CLI::IsMember({"auto", "portable", "embree"}).description(""))
      ->capture_default_str()
      ->group(kGroup);
  command.add_option("--workers", render.workers, "Worker processes")
      ->type_name("N")
      ->check(whole_number(1, kMaxWorkers).description(""))
      ->capture_default_str()
      ->group(kGroup);
  command.add_option("--threads", render.threads, "Threads of each worker (default: cores / workers)")
      ->type_name("N")
      ->check(whole_number(1, kMaxThreads).description(""))
      ->group(kGroup);
  command.add_option("--isa", render.isa, "Instruction set of the native backend (default: the widest)")
      ->type_name("NAME")
      ->check(CLI::IsMember({"sse2", "avx2", "avx512"}).description(""))
      ->group(kGroup);
  command
      .add_option("--opencl-device", render.opencl_device,
                  "OpenCL device: its number, or part of its name or its platform's")
      ->type_name("NAME")
      ->group(kGroup);
}

}  // namespace

void add_report_options(CLI::App& command, ReportOptions& options) {
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
