#include "scheduler/run/option_hints.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string_view>

#include "scenes/names.h"
#include "scenes/settings.h"
#include "scheduler/files/quoting.h"
#include "scheduler/image/picture.h"
#include "worker/cli/help_text.h"

namespace penumbra {
namespace {

struct OtherName {
  std::string_view name;    ///< elsewhere, in snake_case
  const char* here;         ///< what to say here
  const char* option = "";  ///< the option that the command has to have for that; empty: none
};

constexpr OtherName kOtherNames[] = {
    {"samples", "--spp N", "--spp"},
    {"samples_per_pixel", "--spp N", "--spp"},
    {"num_samples", "--spp N", "--spp"},
    {"size", "--set film.width=W --set film.height=H, or --scale 50%", "--scale"},
    {"resolution", "--set film.width=W --set film.height=H, or --scale 50%", "--scale"},
    {"res", "--set film.width=W --set film.height=H, or --scale 50%", "--scale"},
    {"output", "-o FILE", "--out"},
    {"outfile", "-o FILE", "--out"},
    {"output_file", "-o FILE", "--out"},
    {"define", "-D NAME=VALUE", "-D"},
    {"denoiser", "--denoise=METHOD", "--denoise"},
    {"time", "--time-budget SECONDS", "--time-budget"},
    {"time_limit", "--time-budget SECONDS", "--time-budget"},
    {"timeout", "--time-budget SECONDS", "--time-budget"},
    {"region", "--crop X0,Y0,X1,Y1", "--crop"},
    {"window", "--crop X0,Y0,X1,Y1", "--crop"},
    {"cropwindow", "--crop X0,Y0,X1,Y1, in pixels", "--crop"},
    {"gpu", "--backend opencl", "--backend"},
    {"nthreads", "--threads N", "--threads"},
    {"jobs", "--threads N", "--threads"},
};

/// The name of "--max-depth=3": max_depth.
std::string name_of_word(std::string_view word) {
  word.remove_prefix(std::min(word.find_first_not_of('-'), word.size()));
  std::string name = to_snake_case(word.substr(0, word.find('=')));
  std::ranges::replace(name, '-', '_');
  return name;
}

}  // namespace

std::string option_hint(const CommandLine& command, const std::string& word) {
  if (!word.starts_with("--")) return {};
  const std::string name = name_of_word(word);
  const auto has = [&](const std::string& option) {
    return option.empty() || command.find_option(option) != nullptr;
  };
  for (const OtherName& other : kOtherNames)
    if (other.name == name && has(other.option)) return fmt::format("say {}", other.here);
  if (!has("--set")) return {};
  for (const Setting& setting : all_settings())
    if (setting.name() == name) return fmt::format("say --set {}=VALUE", setting.key);
  return {};
}

std::string command_hint(const std::string& word) {
  const std::filesystem::path file = word;
  std::error_code ignored;
  const std::string extension = extension_of(file);
  constexpr std::string_view kScenes[] = {".xml", ".pbrt", ".gltf", ".glb", ".toml", ".blend"};
  const bool is_scene = std::ranges::find(kScenes, extension) != std::end(kScenes);
  const bool is_image = is_image_name(file);
  if (!is_scene && !is_image && !std::filesystem::is_regular_file(file, ignored)) return {};
  const std::string quoted = shell_quoted_file(word);
  return is_image ? fmt::format("to show it: penumbra view {}", quoted)
                  : fmt::format("to render it: penumbra render {}", quoted);
}

Expected<void> check_no_value_is_a_scene(const CommandLine& command, std::span<const std::string> scenes) {
  std::error_code ignored;
  for (const Option* option : command.options()) {
    if (!option->is_given() || option->takes_value() || option->long_names().empty()) continue;
    const std::string& name = option->long_names().front();
    if (option->flag_value(name) == "true") continue;
    std::istringstream values(value_type(*option).values);
    for (std::string value; std::getline(values >> std::ws, value, ',');)
      for (const std::string& scene : scenes)
        if (scene == value && !std::filesystem::exists(scene, ignored))
          return fail(
              fmt::format("'{0}' is taken for a scene here: --{1}={0} gives it to --{1}", value, name));
  }
  return {};
}

}  // namespace penumbra
