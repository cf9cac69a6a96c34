// `penumbra info SCENE`: what a scene holds, what it needs and what is left out for it.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "scheduler/cli/commands.h"
#include "scheduler/cli/loaded_scene.h"
#include "scheduler/outputs/render_record.h"

namespace penumbra {
namespace {

struct InfoOptions {
  SceneOptions scene;
  bool json = false;
};

using Section = std::pair<std::string, std::vector<std::pair<std::string, std::string>>>;

std::string bytes_text(std::size_t bytes) {
  if (bytes < 10240) return fmt::format("{} bytes", bytes);
  if (bytes < 10485760) return fmt::format("{:.1f} KiB", double(bytes) / 1024);
  return fmt::format("{:.1f} MiB", double(bytes) / 1048576);
}

std::size_t device_bytes(const DeviceScene& scene) {
  return sizeof(SceneHeader) + scene.words.size() * sizeof(std::uint32_t);
}

RenderRecord record_of(const SceneOptions& options, const LoadedScene& scene) {
  RenderRecord record;
  record.scene = options.scene;
  record.defines = options.defines;
  record.settings = options.settings;
  record.film = scene.description.film;
  record.sampler = scene.description.sampler;
  record.integrator = scene.description.integrator;
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
    const int* integer = std::get_if<int>(&value);
    settings.emplace_back(name, integer != nullptr ? fmt::to_string(*integer) : std::get<std::string>(value));
  }
  return settings;
}

std::vector<std::pair<std::string, std::string>> contents_of(const LoadedScene& scene) {
  const SceneHeader& header = scene.device.header;
  return {{"shapes", fmt::to_string(scene.description.shapes.size())},
          {"triangles", fmt::to_string(header.triangle_count)},
          {"spheres and disks", fmt::to_string(header.quadric_count)},
          {"materials", fmt::to_string(header.material_count)},
          {"lights", fmt::to_string(header.light_count)},
          {"device scene", bytes_text(device_bytes(scene.device))},
          {"time to build", fmt::format("{:.3f} s", scene.seconds)}};
}

void print_text(const SceneOptions& options, const LoadedScene& scene) {
  fmt::print("{}\n", options.scene);
  const std::vector<Section> sections = {{"Contents", contents_of(scene)},
                                         {"Settings", settings_of(options, scene)},
                                         {"Needs", scene.summary.needs},
                                         {"Left out", scene.summary.left_out}};
  for (const auto& [title, entries] : sections) {
    if (entries.empty()) continue;
    fmt::print("\n{}\n", title);
    for (const auto& [name, value] : entries) fmt::print("  {:<32} {}\n", name, value);
  }
}

void print_json(const SceneOptions& options, const LoadedScene& scene) {
  const auto object = [](const std::vector<std::pair<std::string, std::string>>& entries) {
    auto json = nlohmann::ordered_json::object();
    for (const auto& [name, value] : entries) json[name] = value;
    return json;
  };
  const SceneHeader& header = scene.device.header;
  const Film& film = scene.description.film;
  nlohmann::ordered_json json = {
      {"scene", options.scene},
      {"shapes", scene.description.shapes.size()},
      {"triangles", header.triangle_count},
      {"quadrics", header.quadric_count},
      {"materials", header.material_count},
      {"lights", header.light_count},
      {"film",
       {{"width", film.width},
        {"height", film.height},
        {"crop", {film.crop_x, film.crop_y, film.crop_x + film.crop_width, film.crop_y + film.crop_height}}}},
      {"settings", object(settings_of(options, scene))},
      {"device_scene_bytes", device_bytes(scene.device)},
      {"build_seconds", scene.seconds},
      {"needs", object(scene.summary.needs)},
      {"left_out", object(scene.summary.left_out)},
      {"warnings", scene.description.warnings}};
  fmt::print("{}\n", json.dump(2));
}

ExitCode info(const InfoOptions& options) {
  const auto scene = load_scene(options.scene);
  if (!scene) return print_error(scene.error()), kBadInput;
  if (options.json) {
    print_json(options.scene, *scene);
  } else {
    print_text(options.scene, *scene);
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
  command->footer(
      "Examples:\n"
      "  penumbra info scene.xml\n"
      "  penumbra info scene.xml -D albedo=0.5 --integrator direct --json");
  command->callback([options, &chosen] { chosen = [options] { return info(*options); }; });
}

}  // namespace penumbra
