#include "scheduler/cli/help_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>
#include <utility>
#include <vector>

#include "scheduler/cli/text_layout.h"

namespace penumbra {
namespace {

constexpr int kNames = 28;  // columns for the names of options

std::string names_text(const CLI::Option& option) {
  std::string names;
  const auto add = [&](const std::string& name) { names += (names.empty() ? "" : ", ") + name; };
  for (const std::string& name : option.get_snames()) add("-" + name);
  for (const std::string& name : option.get_lnames()) add("--" + name);
  const std::string value = value_type(option).name;
  return option.get_expected_max() > 0 && !value.empty() ? names + " " + value : names;
}

std::string list_of(const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options) names.push_back(option->get_name());
  std::ranges::sort(names);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string option_text(const CLI::Option& option, int columns) {
  const bool is_positional = option.get_positional();
  std::string text = option.get_description();
  const auto add = [&](const char* label, const std::string& what) {
    if (!what.empty()) text += std::string(" [") + label + what + "]";
  };
  add("", value_type(option).values);
  add("default: ", option.get_default_str());
  if (option.get_required() && !is_positional) add("", "required");
  add("or ", option.get_envname());
  add("with ", list_of(option.get_needs()));
  add("not with ", list_of(option.get_excludes()));
  std::string name = is_positional ? option.get_name(true) : names_text(option);
  if (is_positional && option.get_expected_max() > 1) name += "...";
  return described(name, text, kNames, columns);
}

std::string group_of(const CLI::Option& option) {
  return option.get_positional() && option.get_group() == "Options" ? group::kArguments : option.get_group();
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

class HelpText final : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode) const override {
    const int columns = std::min(text_columns(), kTextColumns);
    std::string text = wrapped(app->get_description() + ".", 0, 0, columns) + "\n\n";
    std::string usage = make_usage(app, std::move(name));
    usage.erase(usage.find_last_not_of('\n') + 1);
    text += wrapped(usage, 0, 4, columns) + "\n";
    text += commands(*app, columns) + options(*app, columns);
    if (const std::string footer = app->get_footer(); !footer.empty()) text += "\n";
    std::istringstream lines(app->get_footer());
    for (std::string line; std::getline(lines, line);)
      text += (line.starts_with(' ') ? line : wrapped(line, 0, 0, columns)) + "\n";
    return text;
  }

 private:
  static std::string commands(const CLI::App& app, int columns) {
    return by_group(
        app.get_subcommands([](const CLI::App*) { return true; }),
        [](const CLI::App* command) { return command->get_group(); },
        [&](const CLI::App* command) {
          return described(command->get_name(), command->get_description(), kNames / 2, columns);
        });
  }

  static std::string options(const CLI::App& app, int columns) {
    return by_group(
        app.get_options(), [](const CLI::Option* option) { return group_of(*option); },
        [&](const CLI::Option* option) { return option_text(*option, columns); });
  }
};

}  // namespace

ValueType value_type(const CLI::Option& option) {
  const std::string type = option.get_type_name();
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

void use_help_text(CLI::App& app) {
  app.formatter(std::make_shared<HelpText>());
  app.get_help_ptr()->description("Show this help")->group(group::kGeneral);
  if (CLI::Option* version = app.get_option_no_throw("--version"); version != nullptr)
    version->description("Show the version")->group(group::kGeneral);
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) use_help_text(*command);
}

}  // namespace penumbra
