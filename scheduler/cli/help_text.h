// `--help` of every program and command.
#pragma once

#include <CLI/CLI.hpp>

namespace penumbra {

// Headings under which options are listed; those of a single command are where they are added.
namespace group {
constexpr const char* kArguments = "Arguments";
constexpr const char* kInput = "Input";
constexpr const char* kSampling = "Integrator and samples";
constexpr const char* kRegion = "Part of the image";
constexpr const char* kOutput = "Output";
constexpr const char* kWorkers = "Workers and devices";
constexpr const char* kNetwork = "Connections";
constexpr const char* kCheckpoints = "Interrupted renders";
constexpr const char* kGeneral = "General";
}  // namespace group

/// The help of the program and of its commands: options by their groups, lines of at most kTextColumns. Of
/// the footer, lines that begin with a space stay as they are, others are wrapped. To be called once all
/// options are there.
void use_help_text(CLI::App& app);

}  // namespace penumbra
