// `penumbra info SCENE`: what a scene holds, what it needs and what is left out for it.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "scheduler/cli/commands.h"
#include "scheduler/cli/loaded_scene.h"
#include "scheduler/cli/scene_costs.h"
#include "scheduler/record/inventory.h"
#include "scheduler/record/render_statistics.h"

namespace penumbra {
namespace {

struct InfoOptions {
  SceneOptions scene;
  bool json = false;
  bool compile = false;
  std::string opencl_device;
};

using Section = std::pair<std::string, std::vector<std::pair<std::string, std::string>>>;

std::size_t device_bytes(const DeviceScene& scene) {
  return sizeof(SceneHeader) + scene.words.size() * sizeof(std::uint32_t);
}

RenderRecord record_of(const SceneOptions& options, const LoadedScene& scene) {
  RenderRecord record;
  static_cast<RenderSettings&>(record) = scene.description;
  record.scene = options.scene;
  record.scene_hash = scene.description.contents_hash;
  record.defines = options.defines;
  record.settings = options.settings;
  record.embree = scene.device.header.intersector == INTERSECTOR_EMBREE;
  return record;
}

std::vector<std::pair<std::string, std::string>> settings_of(const SceneOptions& options,
                                                             const LoadedScene& scene) {
  const Film& film = scene.description.film;
  std::vector<std::pair<std::string, std::string>> settings;
  settings.emplace_back("film", fmt::format("{} x {}", film.width, film.height));
  settings.emplace_back("crop", fmt::format("{},{},{},{}", film.crop_x, film.crop_y,
                                            film.crop_x + film.crop_width, film.crop_y + film.crop_height));
  for (const auto& [name, value] : record_entries(record_of(options, scene))) {
    if (name == "scene" || name == "backend" || name == "samples_per_pass") continue;  // not the scene's
    settings.emplace_back(name, std::visit([](const auto& v) { return fmt::format("{}", v); }, value));
  }
  return settings;
}

std::string info_text(const SceneOptions& options, const LoadedScene& scene,
                      const SceneInventory& inventory) {
  std::string text = fmt::format("{}, read and built in {:.3f} s\n", options.scene, scene.seconds);
  if (!scene.description.dialect.empty()) text += fmt::format("Dialect: {}\n", scene.description.dialect);
  const std::vector<Section> sections = {{"Needs", scene.summary.needs},
                                         {"Left out", scene.summary.left_out},
                                         {"Settings", settings_of(options, scene)}};
  for (const auto& [title, entries] : sections) {
    if (entries.empty()) continue;
    text += fmt::format("\n{}\n", title);
    for (const auto& [name, value] : entries) text += fmt::format("  {:<32} {}\n", name, value);
    if (title == "Left out") text += "\n" + inventory_text(inventory);
  }
  return text;
}

std::string info_json(const SceneOptions& options, const LoadedScene& scene,
                      const SceneInventory& inventory) {
  const SceneHeader& header = scene.device.header;  // its first material is black, for what has none
  const Film& film = scene.description.film;
  nlohmann::ordered_json json = {
      {"scene", options.scene},
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
      {"costs", inventory_json(inventory)},
      {"warnings", scene.description.warnings}};
  if (!scene.description.dialect.empty()) json["dialect"] = scene.description.dialect;
  // Names and paths are bytes, not always UTF-8.
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

ExitCode info(const InfoOptions& options) {
  const auto scene = load_scene(options.scene);
  if (!scene) return print_error(scene.error()), kBadInput;
  SceneInventory inventory = scene_costs(scene->description, scene->device, best_isa(), true);
  if (options.compile) {
    const auto times = measure_compile_times(scene->device, options.opencl_device);
    if (!times) return print_error(times.error()), kIncomplete;
    inventory.opencl = *times;
  }
  if (options.json) {
    print_answer(info_json(options.scene, *scene, inventory));
  } else {
    print_answer(info_text(options.scene, *scene, inventory));
    for (const std::string& warning : scene->description.warnings) print_warning(warning);
  }
  return kAllDone;
}

}  // namespace

void add_info_command(CLI::App& app, Command& chosen) {
  CLI::App* command =
      app.add_subcommand("info", "What a scene holds, what it needs, what is left out for it");
  const auto options = std::make_shared<InfoOptions>();
  add_scene_options(*command, options->scene);
  command->add_flag("--json", options->json, "Print JSON");
  CLI::Option* compile = command->add_flag(
      "--compile", options->compile,
      "Measure what compiling OpenCL kernels takes for this scene and with everything: half a minute");
  command->add_option("--opencl-device", options->opencl_device, "On the device whose name contains this")
      ->needs(compile);
  command->footer(
      "Examples:\n"
      "  penumbra info scene.xml\n"
      "  penumbra info scene.xml --compile\n"
      "  penumbra info scene.xml -D albedo=0.5 --integrator direct --json");
  command->callback([options, &chosen] { chosen = [options] { return info(*options); }; });
}

}  // namespace penumbra
