// Generates manual pages in man(7) format from the command line's tables.
#pragma once

#include <string>

#include "worker/cli/command_line.h"

namespace penumbra {

/// The page of a program or of one of its commands. `name` is the page's name, "penumbra-render", and
/// `called` the invocation, "penumbra render". The result depends only on the tables and the version.
std::string man_page(const CommandLine& app, const std::string& name, const std::string& called,
                     const std::string& version);

}  // namespace penumbra
