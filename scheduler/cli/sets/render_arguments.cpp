#include "scheduler/cli/sets/render_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "scenes/names.h"
#include "scenes/settings.h"

namespace penumbra {
namespace {

/// Options of the whole command, not of single renders.
constexpr std::array<std::string_view, 21> kShared{
    "workers",    "keys", "launch", "estimate", "json",    "listen",  "address-file",
    "tev",        "web",  "quiet",  "force",    "summary", "table",   "pixel",
    "statistics", "out",  "help",   "help-all", "resume",  "restart", "checkpoint-interval"};
constexpr const char *kDefine = "-D", *kSet = "--set";

std::string name_of(const Option& option) {
  return option.long_names().empty() ? "" : option.long_names().front();
}

/// A parser for the command line of `penumbra render`.
struct Parser {
  RenderOptions options;
  CommandLine app{"render", "render"};

  Parser() { add_render_options(app, options); }
};

/// Keyed by each of their long names.
const std::map<std::string, RenderOption, std::less<>>& render_options() {
  static const auto all = [] {
    std::map<std::string, RenderOption, std::less<>> options;
    Parser parser;
    for (const Option* option : parser.app.options()) {
      const std::string first = name_of(*option);
      if (first.empty() || first == "set" || is_shared_option(first)) continue;
      const AxisKind kind = option->takes_value() ? AxisKind::kOption : AxisKind::kFlag;
      const bool has_values = kind == AxisKind::kFlag && option->flag_value(first) != "true";
      for (const std::string& name : option->long_names()) options[name] = {first, kind, has_values};
    }
    return options;
  }();
  return all;
}

void add_argument(std::vector<std::string>& arguments, const RenderAxis& axis, const std::string& value,
                  bool with_frame) {
  switch (axis.kind) {
    case AxisKind::kScene:
      break;  // after all options
    case AxisKind::kFrame:
      if (with_frame) arguments.insert(arguments.end(), {kDefine, "frame=" + value});
      break;
    case AxisKind::kDefine:
      arguments.insert(arguments.end(), {kDefine, axis.name + "=" + value});
      break;
    case AxisKind::kSetting:
      arguments.insert(arguments.end(), {kSet, axis.name + "=" + value});
      break;
    case AxisKind::kOption:
      arguments.push_back("--" + axis.name + "=" + value);
      break;
    case AxisKind::kFlag:
      if (value != "false") arguments.push_back("--" + axis.name + (value == "true" ? "" : "=" + value));
      break;
  }
}

/// Adds name=value pairs; of equal names the last is used.
void add_assignments(std::vector<RenderAxis>& axes, AxisKind kind,
                     const std::vector<std::string>& assignments) {
  for (const std::string& text : assignments) {
    const std::size_t equals = text.find('=');
    set_axis(axes, {kind, text.substr(0, equals), {text.substr(equals + 1)}});
  }
}

}  // namespace

const RenderOption* find_render_option(std::string_view long_name) {
  const auto found = render_options().find(long_name);
  return found == render_options().end() ? nullptr : &found->second;
}

const std::vector<std::string>& render_option_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, option] : render_options())
      if (name == option.name) all.push_back(name);
    return all;
  }();
  return names;
}

bool is_shared_option(std::string_view name) { return std::ranges::find(kShared, name) != kShared.end(); }

Expected<void> check_value(AxisKind kind, const std::string& name, const std::string& value) {
  if (kind == AxisKind::kFlag && value != "true" && value != "false" && !find_render_option(name)->has_values)
    return fail(fmt::format("{} is true or false, not '{}'", name, value));
  if (kind == AxisKind::kSetting && find_setting(to_snake_case(name)) == nullptr) {
    RenderSettings none;
    return apply_setting(none, name, value);  // its error lists the known names
  }
  std::vector<std::string> arguments;
  add_argument(arguments, {kind, name, {}}, value, true);
  arguments.insert(arguments.end(), {"--", "scene.xml"});
  return Parser().app.parse(std::move(arguments));
}

std::vector<std::string> render_words(const CommandLine& command, std::span<const std::string_view> without) {
  const Parser render;
  std::vector<std::string> scenes, words;
  for (const Option* option : command.options()) {
    const std::string name = name_of(*option);
    if (option->is_positional())
      for (const std::string& scene : option->results())
        scenes.push_back(scene.starts_with('-') ? "./" + scene : scene);
    const std::string word = name.empty() ? kDefine : "--" + name;
    if (!option->is_given() || option->is_positional() || std::ranges::find(without, name) != without.end() ||
        render.app.find_option(word) == nullptr)
      continue;
    const bool is_flag = !option->takes_value();
    for (const std::string& value : option->results()) {
      if (name.empty())
        words.push_back(kDefine + value);
      else
        add_argument(words, {is_flag ? AxisKind::kFlag : AxisKind::kOption, name, {}}, value, false);
    }
  }
  scenes.insert(scenes.end(), words.begin(), words.end());
  return scenes;
}

std::vector<RenderAxis> axes_of_command(const CommandLine& command) {
  std::vector<RenderAxis> axes;
  for (const Option* option : command.options()) {
    const std::string name = name_of(*option);
    if (!option->is_given() || option->is_positional()) continue;
    if (name.empty())
      add_assignments(axes, AxisKind::kDefine, option->results());
    else if (name == "set")
      add_assignments(axes, AxisKind::kSetting, option->results());
    else if (const RenderOption* known = find_render_option(name))
      set_axis(axes, {known->kind, name, {option->results().back()}});
  }
  return axes;
}

Expected<RenderOptions> options_of(const std::vector<RenderAxis>& axes, const RenderChoice& choice,
                                   const RenderOptions& shared, bool with_frame) {
  std::vector<std::string> arguments;
  std::string scene;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (axes[i].kind == AxisKind::kScene) scene = choice[i];
    add_argument(arguments, axes[i], choice[i], with_frame);
  }
  arguments.insert(arguments.end(), {"--", scene});
  Parser parser;
  if (const auto parsed = parser.app.parse(std::move(arguments)); !parsed)
    return std::unexpected(parsed.error());
  RenderOptions options = std::move(parser.options);
  options.scene.scene = scene;
  options.workers = shared.workers;
  options.listen = shared.listen;
  options.address_file = shared.address_file;
  options.keys = shared.keys;
  options.launch = shared.launch;
  options.tev = shared.tev;
  options.resume = shared.resume;
  options.restart = shared.restart;
  options.checkpoint_interval = shared.checkpoint_interval;
  return options;
}

}  // namespace penumbra
