// What every program answers about its own command line: `PROGRAM complete WORD…` to shells, `PROGRAM man` a
// page of the manual.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/cli/completion.h"
#include "scheduler/cli/exit_code.h"

namespace penumbra {

/// Of a program that is called `app`'s name, whose arguments are these; nothing if they ask for something
/// else.
std::optional<ExitCode> answer_about(const CLI::App& app, const std::vector<std::string>& arguments,
                                     const ValuesOf& values = {});

}  // namespace penumbra
