// The commands of `penumbra`: each adds itself to the command line, and runs once that is parsed.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/console.h"
#include "scheduler/cli/exit_code.h"

namespace penumbra {

/// What is to run, chosen by the parse: the command's body.
using Command = std::function<ExitCode()>;

/// `command_line` is argv; both outlive the parse and the run.
void add_render_command(CLI::App& app, const std::vector<std::string>& command_line, Command& chosen);
void add_preview_command(CLI::App& app, Command& chosen);
void add_report_command(CLI::App& app, const std::vector<std::string>& command_line, Command& chosen);
void add_info_command(CLI::App& app, Command& chosen);
void add_settings_command(CLI::App& app, Command& chosen);
void add_plugins_command(CLI::App& app, Command& chosen);
void add_convert_command(CLI::App& app, Command& chosen);
void add_compare_command(CLI::App& app, Command& chosen);
// Of services.
void add_serve_command(CLI::App& app, Command& chosen);
void add_submit_command(CLI::App& app, const std::vector<std::string>& command_line, Command& chosen);
void add_status_command(CLI::App& app, Command& chosen);
void add_change_commands(CLI::App& app, Command& chosen);
void add_fetch_command(CLI::App& app, Command& chosen);
/// After all others, of which it knows the names.
void add_reference_commands(CLI::App& app, Command& chosen);
/// `penumbra complete WORD…` and `penumbra man …`, also of commands that are programs of their own; nothing:
/// other arguments, or wrong ones.
std::optional<ExitCode> answer_reference(const CLI::App& app, const std::vector<std::string>& arguments);
/// Commands that are programs of their own, such as `penumbra worker`: listed for the help, they never get to
/// the parser, see run_sibling.
void add_sibling_commands(CLI::App& app);

/// The program that the command is, or an empty text.
std::string sibling_program(const std::string& command);
/// Replaces this process by that program with these arguments; returns only if there is no such program.
ExitCode run_sibling(const std::string& program, const std::vector<std::string>& arguments);

}  // namespace penumbra
