// The options by which a client of a scheduler is told what to show.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace penumbra {

/// Adds --keys. `what_for`: beginning of its help, as in "The scheduler's keys".
CLI::Option* add_keys_option(CLI::App& app, std::string& folder, const std::string& what_for);
/// Answers --token, which there is not: other users see the words of a command.
void add_token_refusal(CLI::App& app);
/// Both, of a client.
void add_client_access_options(CLI::App& app, std::string& folder);

}  // namespace penumbra
