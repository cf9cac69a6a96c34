// A page of the manual, in man(7)'s language, from the tables that parse a command line.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace penumbra {

/// Of a program, or of one of its commands: `name` is the page's, "penumbra-render", and `called` how it is
/// called, "penumbra render". Depends on the tables and the version alone.
std::string man_page(const CLI::App& app, const std::string& name, const std::string& called,
                     const std::string& version);

}  // namespace penumbra
