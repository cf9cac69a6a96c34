// What is right instead of words that a command line does not take.
#pragma once

#include <span>
#include <string>

#include "kernels/host/error.h"
#include "worker/cli/command_line.h"

namespace penumbra {

/// Of an option that this command does not have, under a name that other programs or scene files have: how it
/// is said here, as in "say --spp N" for --samples and "say --set film.width=VALUE" for --width. Empty: not
/// known.
std::string option_hint(const CommandLine& command, const std::string& word);

/// Of the first word of the program, if it is a file and no command: which command takes it. Empty: it is
/// not.
std::string command_hint(const std::string& word);

/// Error if a value was meant for an option that takes it only after '=', and was taken for a scene: `render
/// a.xml --denoise nfor`.
Expected<void> check_no_value_is_a_scene(const CommandLine& command, std::span<const std::string> scenes);

}  // namespace penumbra
