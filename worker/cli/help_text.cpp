#include "worker/cli/help_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <sstream>
#include <utility>
#include <vector>

#include "worker/cli/text_layout.h"

namespace penumbra {
namespace {

constexpr int kNames = 28;  // columns for the names of options

std::string names_text(const Option& option) {
  std::string names;
  const auto add = [&](const std::string& name) { names += (names.empty() ? "" : ", ") + name; };
  for (const std::string& name : option.short_names()) add("-" + name);
  for (const std::string& name : option.long_names()) add("--" + name);
  const std::string value = value_type(option).name;
  return option.takes_value() && !value.empty() ? names + " " + value : names;
}

/// Hidden options have no name.
std::string list_of(std::vector<std::string> names) {
  std::erase(names, "");
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string option_text(const Option& option, int columns) {
  const bool is_positional = option.is_positional();
  std::string text = option.description();
  const auto add = [&](const char* label, const std::string& what) {
    if (!what.empty()) text += std::string(" [") + label + what + "]";
  };
  add("", value_type(option).values);
  add("default: ", option.default_str());
  if (option.is_required() && !is_positional) add("", "required");
  add("or ", option.envname());
  add("with ", list_of(option.needed()));
  add("not with ", list_of(option.excluded()));
  std::string name = is_positional ? option.name() : names_text(option);
  if (is_positional && option.takes_several_values()) name += "...";
  return described(name, text, kNames, columns);
}

std::string group_of(const Option& option) {
  return option.is_positional() && option.group() == "Options" ? group::kArguments : option.group();
}

/// The texts of all items under their groups, in the order of the groups' first items. What every command has
/// comes last; items without a group are hidden.
template <typename Items, typename GroupOf, typename TextOf>
std::string by_group(const Items& items, GroupOf group_of, TextOf text_of) {
  using Group = std::pair<std::string, std::string>;  // name, text
  std::vector<Group> groups;
  for (const auto* item : items) {
    const std::string name = group_of(item);
    if (name.empty()) continue;
    auto group = std::ranges::find(groups, name, &Group::first);
    if (group == groups.end()) group = groups.insert(group, {name, "\n" + name + ":\n"});
    group->second += text_of(item);
  }
  if (const auto general = std::ranges::find(groups, group::kGeneral, &Group::first); general != groups.end())
    std::rotate(general, general + 1, groups.end());
  std::string text;
  for (const auto& [name, of_group] : groups) text += of_group;
  return text;
}

std::string commands_text(const CommandLine& command, int columns) {
  return by_group(
      command.commands(), [](const CommandLine* each) { return each->group(); },
      [&](const CommandLine* each) {
        return described(each->name(), each->description(), kNames / 2, columns);
      });
}

std::string options_text(const CommandLine& command, bool is_short, int columns) {
  std::vector<Option*> options = command.options();
  if (is_short)
    std::erase_if(options, [&](const Option* option) {
      return !command.short_help().contains(option) && option->group() != group::kGeneral;
    });
  return by_group(
      options, [](const Option* option) { return group_of(*option); },
      [&](const Option* option) { return option_text(*option, columns); });
}

std::string examples_of(const std::string& footer) {
  const std::size_t at = footer.find("Examples:\n");
  return at == std::string::npos ? std::string() : footer.substr(at);
}

}  // namespace

ValueType value_type(const Option& option) {
  const std::string type = option.type();
  const std::size_t colon = type.find(':');
  // In an address, and in a method with parameters, the colon is part of the value.
  if (colon == std::string::npos || (colon > 0 && type[colon - 1] == '[') ||
      (colon + 1 < type.size() && std::isupper((unsigned char)type[colon + 1])))
    return {type, ""};
  std::string values = type.substr(colon + 1);
  if (values.starts_with("{") && values.ends_with("}")) {
    values = values.substr(1, values.size() - 2);
    for (std::size_t at = values.find(','); at != std::string::npos; at = values.find(',', at + 2))
      values.insert(at + 1, " ");
  }
  return {type.substr(0, colon), values};
}

std::string help_text(const CommandLine& command, std::string usage, bool is_short) {
  const int columns = std::min(text_columns(), kTextColumns);
  usage.erase(usage.find_last_not_of('\n') + 1);
  std::string text = wrapped(command.description() + ".", 0, 0, columns) + "\n\n" +
                     wrapped(usage, 0, 4, columns) + "\n" + commands_text(command, columns) +
                     options_text(command, is_short, columns);
  std::string footer = command.footer();
  if (is_short) footer = fmt::format("--help-all shows all options and more.\n\n{}", examples_of(footer));
  if (!footer.empty()) text += "\n";
  std::istringstream lines(footer);
  for (std::string line; std::getline(lines, line);)
    text += (line.starts_with(' ') ? line : wrapped(line, 0, 0, columns)) + "\n";
  return text;
}

}  // namespace penumbra
