// The commands of `penumbra`. Each function adds a command to the command line; the command runs after
// parsing.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/console.h"
#include "worker/cli/command_line.h"
#include "worker/cli/exit_code.h"

namespace penumbra {

/// The command chosen by the parser: a function that runs it.
using Command = std::function<ExitCode()>;

/// `command_line` is argv. It and `chosen` must outlive parsing and running.
void add_render_command(CommandLine& app, const std::vector<std::string>& command_line, Command& chosen);
void add_preview_command(CommandLine& app, Command& chosen);
void add_report_command(CommandLine& app, const std::vector<std::string>& command_line, Command& chosen);
/// Manages the keys of schedulers that other hosts can reach.
void add_keys_command(CommandLine& app, Command& chosen);
void add_info_command(CommandLine& app, Command& chosen);
void add_advise_command(CommandLine& app, Command& chosen);
void add_settings_command(CommandLine& app, Command& chosen);
void add_plugins_command(CommandLine& app, Command& chosen);
void add_convert_command(CommandLine& app, Command& chosen);
void add_denoise_command(CommandLine& app, Command& chosen);
void add_merge_command(CommandLine& app, const std::vector<std::string>& command_line, Command& chosen);
void add_compare_command(CommandLine& app, Command& chosen);
/// Writes, and submits, a render as jobs for Slurm.
void add_sbatch_command(CommandLine& app, Command& chosen);
// Commands for services.
void add_serve_command(CommandLine& app, Command& chosen);
void add_submit_command(CommandLine& app, const std::vector<std::string>& command_line, Command& chosen);
void add_status_command(CommandLine& app, Command& chosen);
void add_change_commands(CommandLine& app, Command& chosen);
void add_fetch_command(CommandLine& app, Command& chosen);
/// Must be called after all others, because it uses their names.
void add_reference_commands(CommandLine& app, Command& chosen);
/// Answers `penumbra complete WORD…` and `penumbra man …`, also for commands that are separate programs.
/// Nothing for other or invalid arguments.
std::optional<ExitCode> answer_reference(const CommandLine& app, const std::vector<std::string>& arguments);
/// Lists commands that are separate programs, such as `penumbra worker`, in the help. They are executed
/// before parsing; see run_sibling.
void add_sibling_commands(CommandLine& app);

/// The path of the program that implements the command, or an empty text.
std::string sibling_program(const std::string& command);
/// Replaces this process by that program. Returns only if it cannot be executed.
ExitCode run_sibling(const std::string& program, const std::vector<std::string>& arguments);

}  // namespace penumbra
