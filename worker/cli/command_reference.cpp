#include "worker/cli/command_reference.h"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string>
#include <vector>

#include "kernels/host/console.h"
#include "worker/cli/command_description.h"
#include "worker/cli/command_line.h"
#include "worker/cli/help_text.h"

namespace penumbra {
namespace {

// Manual pages in man(7) format, from the command line's tables.

/// Escapes text so that man interprets nothing in it.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
  }
  if (result.starts_with('.') || result.starts_with('\'')) result.insert(0, "\\&");
  return result;
}

std::string bold(const std::string& text) { return "\\fB" + escaped(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + escaped(text) + "\\fR"; }

std::string in_capitals(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::toupper(c)); });
  return text;
}

std::string section(const std::string& title) { return ".SH " + escaped(in_capitals(title)) + "\n"; }

std::string sentence_end(const std::string& text) {
  return text.empty() || text.ends_with('.') || text.ends_with('"') ? "" : ".";
}

std::string option_text(const Option& option) {
  std::string text = ".TP\n";
  const ValueType type = value_type(option);
  if (option.is_positional()) {
    text += italic(option.name());
  } else {
    std::string names;
    const auto add = [&](const std::string& name) { names += (names.empty() ? "" : ", ") + bold(name); };
    for (const std::string& name : option.short_names()) add("-" + name);
    for (const std::string& name : option.long_names()) add("--" + name);
    text += names;
    if (option.takes_value() && !type.name.empty()) text += " " + italic(type.name);
  }
  text += "\n" + escaped(option.description()) + sentence_end(option.description()) + "\n";
  if (!type.values.empty()) text += escaped("Values: " + type.values) + ".\n";
  if (!option.default_str().empty()) text += escaped("Default: " + option.default_str()) + ".\n";
  if (!option.envname().empty()) text += "Environment: " + bold(option.envname()) + ".\n";
  return text;
}

std::string options_text(const CommandLine& app) {
  std::vector<std::string> groups = {"Arguments"};
  for (const Option* option : app.options()) {
    const std::string& group = option->group();
    if (!option->is_positional() && !group.empty() && std::ranges::find(groups, group) == groups.end())
      groups.push_back(group);
  }
  std::string text;
  for (const std::string& group : groups) {
    std::string options;
    for (const Option* option : app.options())
      if ((option->is_positional() ? "Arguments" : option->group()) == group) options += option_text(*option);
    if (!options.empty()) text += section(group) + options;
  }
  return text;
}

std::string synopsis(const CommandLine& app, const std::string& called) {
  std::string text = section("Synopsis") + bold(called) + " [" + italic("OPTIONS") + "]";
  for (const Option* option : app.options()) {
    if (!option->is_positional()) continue;
    std::string name = italic(option->name());
    if (option->takes_several_values()) name += " ...";
    text += option->is_required() ? " " + name : " [" + name + "]";
  }
  if (!app.commands().empty()) text += " " + italic("COMMAND") + " ...";
  return text + "\n";
}

std::string commands_text(const CommandLine& app, const std::string& name) {
  std::string text;
  for (const CommandLine* command : app.commands())
    if (!command->group().empty())
      text += ".TP\n" + bold(name + "-" + command->name()) + "(1)\n" + escaped(command->description()) +
              sentence_end(command->description()) + "\n";
  return text.empty() ? "" : section("Commands") + text;
}

/// Paragraphs of the footer, and its examples verbatim.
std::string footer_text(const std::string& footer) {
  std::string text;
  std::istringstream lines(footer);
  bool examples = false;
  for (std::string line; std::getline(lines, line);) {
    if (line == "Examples:") {
      text += section("Examples") + ".nf\n";
      examples = true;
    } else if (examples) {
      text += escaped(line.starts_with("  ") ? line.substr(2) : line) + "\n";
    } else {
      if (text.empty()) text = section("Notes");
      text += line.empty() ? ".PP\n" : escaped(line) + "\n";
    }
  }
  // Remove empty paragraphs before headings.
  for (std::size_t at = text.find(".PP\n.SH"); at != std::string::npos; at = text.find(".PP\n.SH"))
    text.erase(at, 4);
  return text + (examples ? ".fi\n" : "");
}

/// The page of a program or of one of its commands. `name` is the page's name, "penumbra-render", and
/// `called` the invocation, "penumbra render". The result depends only on the tables and the version.
std::string man_page(const CommandLine& app, const std::string& name, const std::string& called,
                     const std::string& version) {
  const std::string description = app.description();
  return ".TH " + escaped(in_capitals(name)) + " 1 \"\" \"Penumbra " + escaped(version) + "\" Penumbra\n" +
         section("Name") + escaped(name) + " \\- " + escaped(description) + "\n" + synopsis(app, called) +
         commands_text(app, name) + options_text(app) + footer_text(app.footer());
}

}  // namespace

std::optional<ExitCode> answer_about(const CommandLine& app, const std::vector<std::string>& arguments,
                                     const ValuesOf& values) {
  if (arguments.empty()) return std::nullopt;
  const std::vector<std::string> rest(arguments.begin() + 1, arguments.end());
  if (arguments[0] == "complete") {
    print_answer(completion_text(complete(app, rest, values)));
    return kAllDone;
  }
  if (arguments[0] == "describe" && rest.empty()) {
    print_answer(command_description(app, PENUMBRA_VERSION));
    return kAllDone;
  }
  const std::string called = app.name();
  std::string name = called;  // the page's name: for "penumbra stress" it is penumbra-stress
  std::ranges::replace(name, ' ', '-');
  if (arguments[0] == "man" && rest.empty()) {
    print_answer(man_page(app, name, called, PENUMBRA_VERSION));
    return kAllDone;
  }
  if (arguments[0] == "man" && rest.size() == 1 && !rest[0].starts_with("-")) {
    const CommandLine* command = app.find_command(rest[0]);
    if (command == nullptr) return std::nullopt;
    print_answer(man_page(*command, name + "-" + rest[0], name + " " + rest[0], PENUMBRA_VERSION));
    return kAllDone;
  }
  return std::nullopt;
}

}  // namespace penumbra
