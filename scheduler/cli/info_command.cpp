// `penumbra info SCENE`: prints the contents of a scene; with --verbose also the features that it needs and
// those left out.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "scheduler/cli/commands.h"
#include "scheduler/estimate/scene_contents.h"
#include "scheduler/record/inventory.h"
#include "scheduler/record/render_statistics.h"
#include "scheduler/run/loaded_scene.h"
#include "scheduler/run/scene_costs.h"
#include "worker/cli/help_text.h"
#include "worker/cli/text_layout.h"

namespace penumbra {
namespace {

struct InfoOptions {
  RenderRequest render;
  bool json = false, verbose = false;
  bool compile = false;
  std::string opencl_device;
};

using Section = std::pair<std::string, NamedTexts>;
constexpr const char* kFeature = "feature";  // the name of summary entries that are features

struct SceneFacts {
  SceneContents contents;
  SceneInventory inventory;
};

std::size_t device_bytes(const DeviceScene& scene) {
  return sizeof(SceneHeader) + scene.words.size() * sizeof(std::uint32_t);
}

RenderRecord record_of(const SceneOptions& options, const LoadedScene& scene) {
  RenderRecord record;
  static_cast<RenderSettings&>(record) = scene.description;
  record.scene = options;
  record.scene_hash = scene.description.contents_hash;
  record.scene.intersector = scene.device.header.intersector == INTERSECTOR_EMBREE ? "embree" : "portable";
  return record;
}

NamedTexts settings_of(const SceneOptions& options, const LoadedScene& scene) {
  const Film& film = scene.description.film;
  NamedTexts settings;
  settings.emplace_back("film", fmt::format("{} x {}", film.width, film.height));
  settings.emplace_back("crop", fmt::format("{},{},{},{}", film.crop_x, film.crop_y,
                                            film.crop_x + film.crop_width, film.crop_y + film.crop_height));
  for (const auto& [name, value] : record_entries(record_of(options, scene))) {
    // Not properties of the scene.
    if (name == "scene" || name == "backend" || name == "samples_per_pass") continue;
    settings.emplace_back(name, std::visit([](const auto& v) { return fmt::format("{}", v); }, value));
  }
  return settings;
}

/// The summary without its features, which --verbose shows.
NamedTexts without_features(NamedTexts entries) {
  std::erase_if(entries, [](const auto& entry) { return entry.first == kFeature; });
  return entries;
}

std::string section_text(const Section& section, int columns) {
  if (section.second.empty()) return "";
  std::string text = fmt::format("\n{}\n", section.first);
  for (const auto& [name, value] : section.second) text += described(name, value, 34, columns);
  return text;
}

std::string info_text(const InfoOptions& options, const LoadedScene& scene, const SceneFacts& facts) {
  const int columns = text_columns();
  std::string text =
      fmt::format("{}, read and built in {:.3f} s\n", options.render.scene.file, scene.seconds);
  if (!scene.description.dialect.empty()) text += fmt::format("Dialect: {}\n", scene.description.dialect);
  for (const Section& section : contents_text(facts.contents)) text += section_text(section, columns);
  const auto& [needs, left_out] = std::tie(scene.summary.needs, scene.summary.left_out);
  text += section_text({"Device scene", options.verbose ? needs : without_features(needs)}, columns);
  text += section_text({"Left out", options.verbose ? left_out : without_features(left_out)}, columns);
  if (options.verbose || options.compile) text += "\n" + inventory_text(facts.inventory);
  return text + section_text({"Settings", settings_of(options.render.scene, scene)}, columns);
}

std::string info_json(const SceneOptions& options, const LoadedScene& scene, const SceneFacts& facts) {
  const SceneHeader& header = scene.device.header;  // the first material is black, for shapes without a BSDF
  const Film& film = scene.description.film;
  nlohmann::ordered_json json = {
      {"scene", options.file},
      {"shapes", scene.description.shapes.size()},
      {"triangles", header.tables.triangles.count},
      {"quadrics", header.tables.quadrics.count},
      {"materials", header.tables.materials.count - 1},
      {"lights", header.tables.lights.count},
      {"film",
       {{"width", film.width},
        {"height", film.height},
        {"crop", {film.crop_x, film.crop_y, film.crop_x + film.crop_width, film.crop_y + film.crop_height}}}},
      {"settings", grouped_json(settings_of(options, scene))},
      {"device_scene_bytes", device_bytes(scene.device)},
      {"build_seconds", scene.seconds},
      {"needs", grouped_json(scene.summary.needs)},
      {"left_out", grouped_json(scene.summary.left_out)},
      {"costs", inventory_json(facts.inventory)},
      {"warnings", scene.description.warnings}};
  add_contents(json, facts.contents);
  if (!scene.description.dialect.empty()) json["dialect"] = scene.description.dialect;
  // Names and paths may be invalid UTF-8.
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

ExitCode info(const InfoOptions& options) {
  const auto scene = load_scene(options.render.scene);
  if (!scene) return print_error(scene.error()), kBadInput;
  auto contents = contents_of(scene->description);
  if (!contents) return print_error(contents.error()), kBadInput;
  SceneFacts facts{std::move(*contents), scene_costs(scene->description, scene->device, best_isa(),
                                                     options.json || options.verbose)};
  if (options.compile) {
    const auto times = measure_compile_times(scene->device, options.opencl_device);
    if (!times) return print_error(times.error()), kIncomplete;
    facts.inventory.opencl = *times;
  }
  if (options.json) {
    print_answer(info_json(options.render.scene, *scene, facts));
  } else {
    print_answer(info_text(options, *scene, facts));
    for (const std::string& warning : scene->description.warnings) print_warning(warning);
  }
  return kAllDone;
}

}  // namespace

void add_info_command(CommandLine& app, Command& chosen) {
  CommandLine* command =
      app.add_command("info", "Show what a scene holds: size, geometry, textures, lights, files, settings");
  const auto options = std::make_shared<InfoOptions>();
  add_scene_options(*command, options->render);
  command->default_group(group::kOutput);
  command->add_flag("--json", options->json, "Print JSON, with all that --verbose shows");
  command->add_flag("-v,--verbose", options->verbose,
                    "Show the features that the scene uses, what is left out, and the bytes of each table");
  Option* compile = command->add_flag(
      "--compile", options->compile,
      "Measure how long OpenCL kernels compile for this scene, and with all features: half a minute");
  command
      ->add_option("--opencl-device", options->opencl_device,
                   "OpenCL device: its number, or part of its name or its platform's")
      ->type_name("NAME")
      ->needs(compile);
  command->footer(
      "Examples:\n"
      "  penumbra info scene.xml\n"
      "  penumbra info scene.xml --compile\n"
      "  penumbra info scene.xml -D albedo=0.5 --integrator direct --json");
  command->callback([options, &chosen] { chosen = [options] { return info(*options); }; });
}

}  // namespace penumbra
