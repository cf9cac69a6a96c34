// Checks a command's outputs against its inputs.
#pragma once

#include <filesystem>
#include <span>

#include "kernels/host/error.h"

namespace penumbra {

/// Checks that every output can be written (see check_writable), that none is an input, and that no two are
/// the same file; existing files are compared by identity, not by name. Call it before the work, and
/// make_folders after it.
Expected<void> check_outputs(std::span<const std::filesystem::path> outputs,
                             std::span<const std::filesystem::path> inputs);

}  // namespace penumbra
