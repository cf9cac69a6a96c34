#include "scheduler/cli/help_text.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include "scheduler/cli/option_text.h"
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
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
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
    const auto all = app.get_subcommands([](const CLI::App* each) { return !each->get_group().empty(); });
    std::vector<std::string> groups;
    for (const CLI::App* command : all)
      if (std::ranges::find(groups, command->get_group()) == groups.end())
        groups.push_back(command->get_group());
    std::string text;
    for (const std::string& group : groups) {
      text += "\n" + group + ":\n";
      for (const CLI::App* command : all)
        if (command->get_group() == group)
          text += described(command->get_name(), command->get_description(), kNames / 2, columns);
    }
    return text;
  }

  static std::string options(const CLI::App& app, int columns) {
    std::vector<std::string> groups;
    for (const CLI::Option* option : app.get_options())
      if (const std::string group = group_of(*option);
          !group.empty() && std::ranges::find(groups, group) == groups.end())
        groups.push_back(group);
    // What every command has comes last.
    if (const auto general = std::ranges::find(groups, group::kGeneral); general != groups.end())
      std::rotate(general, general + 1, groups.end());
    std::string text;
    for (const std::string& group : groups) {
      text += "\n" + group + ":\n";
      for (const CLI::Option* option : app.get_options())
        if (group_of(*option) == group) text += option_text(*option, columns);
    }
    return text;
  }
};

}  // namespace

void use_help_text(CLI::App& app) {
  app.formatter(std::make_shared<HelpText>());
  app.get_help_ptr()->description("Show this help")->group(group::kGeneral);
  if (CLI::Option* version = app.get_option_no_throw("--version"); version != nullptr)
    version->description("Show the version")->group(group::kGeneral);
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) use_help_text(*command);
}

}  // namespace penumbra
