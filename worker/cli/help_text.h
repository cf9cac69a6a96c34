// The `--help` text of all programs and commands.
#pragma once

#include <string>

#include "worker/cli/command_line.h"

namespace penumbra {

// Headings of option groups that several commands share.
namespace group {
constexpr const char* kArguments = "Arguments";
constexpr const char* kInput = "Input";
constexpr const char* kFrames = "Frames of a scene that moves";
constexpr const char* kSampling = "Integrator and samples";
constexpr const char* kRegion = "Size and part of the image";
constexpr const char* kOutput = "Output";
constexpr const char* kWorkers = "Workers and devices";
constexpr const char* kNetwork = "Connections";
constexpr const char* kCheckpoints = "Interrupted renders";
constexpr const char* kGeneral = "General";
}  // namespace group

/// The help of a program or of one of its commands: options by group, in lines of at most kTextColumns. In
/// the footer, lines that begin with a space are kept, others are wrapped. `usage` is the line that says how
/// to call it. `is_short`: only the options of CommandLine::short_help, and the examples of the footer.
std::string help_text(const CommandLine& command, std::string usage, bool is_short = false);

/// The type of an option's value: for "NAME:{a,b}" the name NAME and the accepted values "a, b".
struct ValueType {
  std::string name, values;
};
ValueType value_type(const Option& option);

}  // namespace penumbra
