#include "scheduler/cli/reference_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "kernels/host/text.h"
#include "scenes/names.h"
#include "scenes/plugin_reference.h"
#include "scenes/settings.h"
#include "worker/cli/text_layout.h"

namespace penumbra {
namespace {

constexpr int kNames = 22;     // columns for names in lists
constexpr int kSettings = 34;  // columns for settings with their groups

std::string default_text(const std::string& value) { return value.empty() ? "" : "; default: " + value; }

std::string parameter_text(const PluginParameter& parameter, int columns) {
  return described(parameter.name, parameter.text, kNames, columns) +
         described("", parameter.values + default_text(parameter.default_value), kNames, columns);
}

std::string plugin_text(const PluginEntry& plugin, int columns) {
  std::string text = wrapped(fmt::format("{} {}: {}", plugin.kind, plugin.name, plugin.text), 0, 4, columns);
  text += "\n";
  const auto list = [&](const char* label, const std::vector<std::string>& names) {
    if (names.empty()) return;
    text += described("", fmt::format("{}: {}", label, fmt::join(names, ", ")), 4, columns);
  };
  list("other names", plugin.aliases);
  list("rendered instead, with a warning, of", plugin.replaces);
  for (const PluginParameter& parameter : plugin.parameters) text += parameter_text(parameter, columns);
  return text;
}

std::string group_of(const Setting& setting) { return setting.key.substr(0, setting.key.find('.')); }

std::string setting_text(const Setting& setting, int columns) {
  std::string text = setting.key + "\n" + described("", setting.description, 4, columns);
  const auto line = [&](const char* label, const std::string& what) {
    if (!what.empty()) text += described("", fmt::format("{}: {}", label, what), 4, columns);
  };
  line("values", setting.values);
  line("default", setting_default(setting));
  line("integrators", fmt::format("{}", fmt::join(integrators_with(setting), ", ")));
  line("option", setting.option.empty() ? "" : "--" + setting.option);
  return text;
}

/// The description's first part, up to a colon or semicolon, for a list.
std::string phrase_of(const Setting& setting) {
  return setting.description.substr(0, setting.description.find_first_of(";:("));
}

std::string join(const std::vector<std::string>& parts) { return fmt::format("{}", fmt::join(parts, "\n")); }

const char* kind_name(SettingKind kind) {
  switch (kind) {
    case SettingKind::kInteger:
      return "integer";
    case SettingKind::kNumber:
      return "number";
    case SettingKind::kBoolean:
      return "boolean";
    case SettingKind::kNumberOrText:
      return "number or text";
    default:
      return "text";
  }
}

using Json = nlohmann::ordered_json;

Json text_or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Error unknown(const char* what, const std::string& name, std::vector<std::string> known) {
  std::ranges::sort(known);
  known.erase(std::unique(known.begin(), known.end()), known.end());
  const std::string hint = suggestion(name, known);
  return {fmt::format("there is no {} '{}'{}", what, name, hint)};
}

}  // namespace

std::string plugins_overview(int columns) {
  std::string text, kind;
  for (const PluginEntry& plugin : all_plugins()) {
    if (plugin.kind != kind) text += fmt::format("{}{}\n", kind.empty() ? "" : "\n", plugin.kind);
    kind = plugin.kind;
    text += described(plugin.name, plugin.phrase(), kNames, columns);
  }
  return text + "\n" +
         wrapped(
             "`penumbra plugins NAME` shows the parameters of a plugin, or of all of a kind. "
             "Unknown plugins are errors; with --lenient a placeholder is rendered, with a warning.",
             0, 0, columns) +
         "\n";
}

Expected<std::string> plugins_text(const std::string& name, int columns) {
  const std::string wanted = to_lower_case(name);
  std::vector<std::string> texts, known;
  for (const PluginEntry& plugin : all_plugins()) {
    if (plugin.kind == wanted || plugin.is_called(wanted)) texts.push_back(plugin_text(plugin, columns));
    known.insert(known.end(), {plugin.kind, plugin.name});
    known.insert(known.end(), plugin.aliases.begin(), plugin.aliases.end());
    known.insert(known.end(), plugin.replaces.begin(), plugin.replaces.end());
  }
  if (texts.empty()) return std::unexpected(unknown("plugin or kind of plugin", name, std::move(known)));
  return join(texts);
}

std::string settings_overview(int columns) {
  std::string text, group;
  for (const Setting& setting : all_settings()) {
    if (group_of(setting) != group)
      text += fmt::format("{}{}\n", group.empty() ? "" : "\n", group_of(setting));
    group = group_of(setting);
    text += described(setting.key, phrase_of(setting), kSettings, columns);
  }
  return text + "\n" +
         wrapped(
             "`penumbra settings NAME` shows the values and the default of a setting, or of all of a "
             "group.",
             0, 0, columns) +
         "\n";
}

Expected<std::string> settings_text(const std::string& name, int columns) {
  const std::string wanted = to_snake_case(name);
  std::vector<std::string> texts, known;
  for (const Setting& setting : all_settings()) {
    if (setting.key == wanted || setting.name() == wanted || group_of(setting) == wanted)
      texts.push_back(setting_text(setting, columns));
    known.insert(known.end(), {setting.key, setting.name(), group_of(setting)});
  }
  if (texts.empty()) return std::unexpected(unknown("setting or group of settings", name, std::move(known)));
  return join(texts);
}

std::string settings_description() {
  Json all = Json::array();
  for (const Setting& setting : all_settings())
    all.push_back({{"key", setting.key},
                   {"kind", kind_name(setting.kind)},
                   {"values", setting.values},
                   {"choices", setting.choices},
                   {"help", setting.description},
                   {"default", text_or_null(setting_default(setting))},
                   {"integrators", integrators_with(setting)},
                   {"option", text_or_null(setting.option)}});
  return all.dump(2) + "\n";
}

std::string plugins_description() {
  Json all = Json::array();
  for (const PluginEntry& plugin : all_plugins()) {
    Json parameters = Json::array();
    for (const PluginParameter& parameter : plugin.parameters)
      parameters.push_back({{"name", parameter.name},
                            {"values", parameter.values},
                            {"default", text_or_null(parameter.default_value)},
                            {"help", parameter.text}});
    all.push_back({{"kind", plugin.kind},
                   {"name", plugin.name},
                   {"aliases", plugin.aliases},
                   {"replaces", plugin.replaces},
                   {"help", plugin.text},
                   {"parameters", parameters}});
  }
  return all.dump(2) + "\n";
}

}  // namespace penumbra
