// Command-line options for a client's credentials.
#pragma once

#include <string>

#include "worker/cli/command_line.h"

namespace penumbra {

/// Adds --keys. `what_for` is the beginning of its help text, for example "The scheduler's keys".
Option* add_keys_option(CommandLine& app, std::string& folder, const std::string& what_for);
/// Rejects --token with an explanation: other users can read a command line.
void add_token_refusal(CommandLine& app);
/// Adds both for a client.
void add_client_access_options(CommandLine& app, std::string& folder);

}  // namespace penumbra
