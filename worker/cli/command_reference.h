// Subcommands of every program that describe its command line: `PROGRAM complete WORD…` for shell completion,
// `PROGRAM man` for manual pages, and `PROGRAM describe` for other programs, as JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "worker/cli/command_line.h"
#include "worker/cli/completion.h"
#include "worker/cli/exit_code.h"

namespace penumbra {

/// Answers such a command of the program named by `app`. Nothing if the arguments ask for something else.
std::optional<ExitCode> answer_about(const CommandLine& app, const std::vector<std::string>& arguments,
                                     const ValuesOf& values = {});

}  // namespace penumbra
