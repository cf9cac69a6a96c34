#include "worker/cli/command_description.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "worker/cli/help_text.h"

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

const char* kind_name(ValueKind kind) {
  switch (kind) {
    case ValueKind::kFlag:
      return "flag";
    case ValueKind::kInteger:
      return "integer";
    case ValueKind::kNumber:
      return "number";
    case ValueKind::kText:
      return "text";
  }
  return "text";
}

Json text_or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json names_of(const Option& option) {
  Json names = Json::array();
  if (option.is_positional()) names.push_back(option.name());
  for (const std::string& name : option.long_names()) names.push_back("--" + name);
  for (const std::string& name : option.short_names()) names.push_back("-" + name);
  return names;
}

/// Empty for plain flags, and for options that need a value.
std::string value_of_flag(const Option& option) {
  if (option.needs_value() || option.kind() == ValueKind::kFlag || option.long_names().empty()) return {};
  return option.flag_value(option.long_names().front());
}

Json description_of(const Option& option) {
  return {{"name", option.name()},
          {"names", names_of(option)},
          {"help", option.description()},
          {"group", option.group()},
          {"kind", kind_name(option.kind())},
          {"value", text_or_null(option.takes_value() ? value_type(option).name : "")},
          {"values", text_or_null(value_type(option).values)},
          {"choices", option.choices()},
          {"default", text_or_null(option.default_str())},
          {"environment", text_or_null(option.envname())},
          {"given_as_flag", text_or_null(value_of_flag(option))},
          {"positional", option.is_positional()},
          {"required", option.is_required()},
          {"repeatable", option.takes_several_values()},
          {"needs", option.needed()},
          {"excludes", option.excluded()}};
}

}  // namespace

std::string command_description(const CommandLine& app, const std::string& version) {
  Json commands = Json::array();
  for (const CommandLine* command : app.commands()) {
    Json options = Json::array();
    for (const Option* option : command->options())
      if (!option->name().empty()) options.push_back(description_of(*option));
    commands.push_back({{"name", command->name()}, {"help", command->description()}, {"options", options}});
  }
  const Json all = {{"program", app.name()}, {"version", version}, {"commands", commands}};
  return all.dump(2) + "\n";
}

}  // namespace penumbra
