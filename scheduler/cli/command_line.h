// How every program's command line ends where there is nothing to run.
#pragma once

#include <CLI/CLI.hpp>
#include <sstream>

#include "kernels/host/console.h"
#include "scheduler/cli/exit_code.h"

namespace penumbra {

/// Prints what CLI11 says to this end of a parse: the help that was asked for, or what is wrong with the
/// usage.
inline ExitCode end_of_parse(const CLI::App& app, const CLI::Error& error) {
  std::ostringstream answer, message;
  const bool is_asked_for = app.exit(error, answer, message) == 0;
  print_answer(answer.str());
  std::string text = message.str();
  if (text.ends_with('\n')) text.pop_back();
  if (!text.empty()) print_message(text);
  return is_asked_for ? kAllDone : kBadInput;
}

}  // namespace penumbra
