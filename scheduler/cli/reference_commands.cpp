// `penumbra completion SHELL` and `penumbra man [COMMAND]`, for building packages.
#include <fmt/format.h>

#include "scenes/settings.h"
#include "scheduler/cli/commands.h"
#include "worker/cli/command_reference.h"

namespace penumbra {
namespace {

std::string help_of(const Setting& setting) { return setting.description + ": " + setting.values; }

/// Candidates for --set: keys, then the values of a setting.
std::vector<Candidate> values_of(const std::string& type, const std::string& typed) {
  if (!type.starts_with("KEY=VALUE")) return {};
  std::vector<Candidate> found;
  const std::size_t equals = typed.find('=');
  if (equals == std::string::npos) {
    for (const Setting& setting : all_settings()) found.push_back({setting.key + "=", help_of(setting)});
    return found;
  }
  const std::string key = typed.substr(0, equals);
  const Setting* setting = find_setting(key);
  if (setting == nullptr) return {};
  for (const std::string& choice : setting->choices) found.push_back({key + "=" + choice, ""});
  if (setting->kind == SettingKind::kBoolean)
    for (const char* choice : {"true", "false"}) found.push_back({key + "=" + choice, ""});
  return found;
}

}  // namespace

void add_reference_commands(CommandLine& app, Command& chosen) {
  CommandLine* completion = app.add_command("completion", "Print the completion script of a shell");
  auto shell = std::make_shared<std::string>();
  completion->add_option("SHELL", *shell, "Shell")
      ->type_name("NAME")
      ->required()
      ->check(one_of({"bash", "zsh", "fish"}));
  completion->footer(
      "Packages install it. By hand:\n"
      "  bash: penumbra completion bash > ~/.local/share/bash-completion/completions/penumbra\n"
      "  zsh:  penumbra completion zsh > _penumbra, in a folder of $fpath\n"
      "  fish: penumbra completion fish > ~/.config/fish/completions/penumbra.fish");
  completion->callback([&chosen, shell] {
    chosen = [shell] {
      print_answer(completion_script(*shell));
      return kAllDone;
    };
  });
  CommandLine* man = app.add_command("man", "Print a manual page of the program or of a command");
  std::vector<std::string> names;
  for (const CommandLine* command : app.commands()) names.push_back(command->name());
  man->add_option_function(
         "COMMAND", [](const std::string&) { return Expected<void>(); }, "Command")
      ->type_name("NAME")
      ->check(one_of(names));
  man->footer("Examples:\n  penumbra man render | man -l -");
}

std::optional<ExitCode> answer_reference(const CommandLine& app, const std::vector<std::string>& arguments) {
  if (arguments.size() > 1 && (arguments[0] == "man" || arguments[0] == "complete")) {
    // In `complete worker` the word itself is still being typed.
    const std::string program = sibling_program(arguments[1]);
    if (!program.empty() && (arguments[0] == "man" || arguments.size() > 2)) {
      std::vector<std::string> rest(arguments.begin() + 2, arguments.end());
      rest.insert(rest.begin(), arguments[0]);
      return run_sibling(program, rest);
    }
  }
  return answer_about(app, arguments, values_of);
}

}  // namespace penumbra
