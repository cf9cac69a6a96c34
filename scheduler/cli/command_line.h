// Common error handling for the command lines of all programs.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "kernels/host/console.h"
#include "kernels/host/text.h"
#include "scheduler/cli/exit_code.h"

namespace penumbra {

/// The names that the command accepts: its options if the unknown word is an option, else its subcommands.
inline std::vector<std::string> known_names(const CLI::App& command, const std::string& unknown) {
  std::vector<std::string> names;
  if (unknown.starts_with("-")) {
    for (const CLI::Option* option : command.get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
  } else {
    for (const CLI::App* subcommand : command.get_subcommands([](const CLI::App*) { return true; })) {
      names.push_back(subcommand->get_name());
    }
  }
  return names;
}

/// The message for a usage error, with a pointer to the help.
inline std::string usage_error(const CLI::App& app, const CLI::Error& error) {
  const auto chosen = app.get_subcommands();
  const CLI::App& command = chosen.empty() ? app : *chosen.front();
  const std::string called = chosen.empty() ? app.get_name() : app.get_name() + " " + command.get_name();
  std::string what = error.what();
  if (const auto unknown = command.remaining(); !unknown.empty()) {
    what = fmt::format("unexpected argument '{}'{}", unknown.front(),
                       suggestion(unknown.front(), known_names(command, unknown.front())));
  }
  return fmt::format("{}: error: {}\nRun '{} --help' for what there is.", called, what, called);
}

/// Prints the result of a parse that ends the program: the requested help, or the usage error.
inline ExitCode end_of_parse(const CLI::App& app, const CLI::Error& error) {
  std::ostringstream answer, ignored;
  if (app.exit(error, answer, ignored) == 0) return print_answer(answer.str()), kAllDone;
  print_message(usage_error(app, error));
  return kBadInput;
}

}  // namespace penumbra
