// What a program's command line takes, for other programs.
#pragma once

#include <string>

#include "worker/cli/command_line.h"

namespace penumbra {

/// JSON: `program`, `version`, `commands` (`name`, `help`, `options`). An option has
/// `name` (as on the command line), `names` (all), `help`, `group`;
/// `kind` (flag, integer, number, text), `value` (what the help calls it), `values` (in words),
/// `choices` (all words that it may be; empty: others);
/// `default` (null: none is shown), `environment` (null: none);
/// `given_as_flag` (the value that it has without one; null: it needs one, or is a plain flag);
/// `positional`, `required`, `repeatable`, `needs`, `excludes` (names of options).
/// Hidden options are left out.
std::string command_description(const CommandLine& app, const std::string& version);

}  // namespace penumbra
