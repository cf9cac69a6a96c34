#include "scheduler/sets/render_arguments.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/names.h"
#include "scenes/settings.h"
#include "scheduler/render/frames.h"

namespace penumbra {
namespace {

std::string name_of(const Option& option) {
  return option.long_names().empty() ? "" : option.long_names().front();
}

/// The command line of `penumbra render`.
const CommandLine& render_command() {
  struct Command {
    RenderOptions options;
    CommandLine line{"render", "render"};

    Command() { add_render_options(line, options); }
  };
  static const Command command;
  return command.line;
}

/// Gives the value of an axis to a request.
Expected<void> apply_axis(const RenderAxis& axis, const std::string& value, RenderRequest& request) {
  std::string name = axis.name, text = value;
  switch (axis.kind) {
    case AxisKind::kScene:
      request.scene.file = value;
      return {};
    case AxisKind::kDefine:
    case AxisKind::kSetting:
      name = axis.kind == AxisKind::kDefine ? "D" : "set";
      text = axis.name + "=" + value;
      break;
    case AxisKind::kFlag:
      if (value == "false") return {};
      break;
    case AxisKind::kFrame:
    case AxisKind::kOption:
      break;
  }
  const RenderOption& option = *find_render_option(name);
  // A flag with values is "true" where it has none.
  if (text == "true" && axis.kind == AxisKind::kFlag) text = option.flag_text();
  if (const auto applied = option.apply(request, text); !applied)
    return fail(fmt::format("{}: {}", option.word(), applied.error().message));
  return {};
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

const RenderOption* find_varied_option(std::string_view long_name) {
  const RenderOption* option = long_name.size() > 1 ? find_render_option(long_name) : nullptr;
  const bool is_varied =
      option != nullptr && option->scope == OptionScope::kEachRender && option->kind != OptionKind::kList;
  return is_varied ? option : nullptr;
}

AxisKind kind_of(const RenderOption& option) {
  if (option.name() == "frame") return AxisKind::kFrame;
  return option.is_flag() ? AxisKind::kFlag : AxisKind::kOption;
}

const std::vector<std::string>& varied_option_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const RenderOption& option : all_render_options())
      if (find_varied_option(option.name()) != nullptr) all.push_back(option.name());
    std::ranges::sort(all);
    return all;
  }();
  return names;
}

bool is_shared_option(std::string_view name) {
  return name != "set" && find_varied_option(name) == nullptr &&
         render_command().find_option(fmt::format("--{}", name)) != nullptr;
}

Expected<void> check_value(AxisKind kind, const std::string& name, const std::string& value) {
  if (kind == AxisKind::kFlag && value != "true" && value != "false" &&
      find_varied_option(name)->kind == OptionKind::kFlag)
    return fail(fmt::format("{} is true or false, not '{}'", name, value));
  if (kind == AxisKind::kSetting && find_setting(to_snake_case(name)) == nullptr) {
    RenderSettings none;
    return apply_setting(none, name, value);  // its error lists the known names
  }
  RenderRequest none;
  return apply_axis({kind, name, {}}, value, none);
}

std::vector<std::string> render_words(const CommandLine& command, std::span<const std::string_view> without) {
  std::vector<std::string> scenes, words;
  for (const Option* option : command.options()) {
    const std::string name = name_of(*option);
    if (option->is_positional())
      for (const std::string& scene : option->results())
        scenes.push_back(scene.starts_with('-') ? "./" + scene : scene);
    const std::string word = name.empty() ? "-D" : "--" + name;
    if (!option->is_given() || option->is_positional() || std::ranges::find(without, name) != without.end() ||
        render_command().find_option(word) == nullptr)
      continue;
    const bool is_flag = !option->takes_value();
    for (const std::string& value : option->results()) {
      if (is_flag && value == "false") continue;
      words.push_back(name.empty() ? word + value : is_flag && value == "true" ? word : word + "=" + value);
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
    else if (name == "frames")
      set_axis(axes, {AxisKind::kFrame, "frame", *frames_of(option->results().back())});
    else if (const RenderOption* known = find_varied_option(name))
      set_axis(axes, {kind_of(*known), name, {option->results().back()}});
  }
  return axes;
}

Expected<RenderOptions> options_of(const std::vector<RenderAxis>& axes, const RenderChoice& choice,
                                   const RenderOptions& shared) {
  RenderOptions options = shared;
  options.scenes.clear();
  options.estimate = false;  // its files are checked as those of a render
  static_cast<RenderRequest&>(options) = {};
  for (std::size_t i = 0; i < axes.size(); ++i)
    if (const auto applied = apply_axis(axes[i], choice[i], options); !applied)
      return std::unexpected(applied.error());
  if (const auto checked = check_exclusions(options); !checked) return std::unexpected(checked.error());
  return options;
}

}  // namespace penumbra
