// How every client of a scheduler proves that it may talk: the options, and what comes of them.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "kernels/host/error.h"
#include "scheduler/keys/key_folder.h"

namespace penumbra {

/// The environment variables from which programs read secrets, or where they are.
inline constexpr const char* kTokenVariable = "PENUMBRA_TOKEN";
inline constexpr const char* kKeysVariable = "PENUMBRA_KEYS";

/// What a client shows. Over a Unix socket neither is needed.
struct ClientAccess {
  std::string token = {};
  std::shared_ptr<const Keys> keys = {};  ///< with them the connection is encrypted
};

/// Adds --keys. `what_for`: beginning of its help, as in "The scheduler's keys".
CLI::Option* add_keys_option(CLI::App& app, std::string& folder, const std::string& what_for);
/// Answers --token, which there is not: other users see the words of a command.
void add_token_refusal(CLI::App& app);
/// Both, of a client.
void add_client_access_options(CLI::App& app, std::string& folder);

/// For a connection to `address` ("unix:/path" or "host:port"): the keys of `folder`, or where that is empty
/// the token of the environment, which this process then forgets, so that no child inherits it. Errors: those
/// of read_keys; a scheduler on another host without keys, since the token would travel for all to read.
Expected<ClientAccess> client_access(const std::string& address, const std::string& folder, KeyRole role);

}  // namespace penumbra
