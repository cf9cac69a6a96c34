// What a command is about to write, held against what it reads.
#pragma once

#include <filesystem>
#include <span>

#include "kernels/host/error.h"

namespace penumbra {

/// Whether every output can be written (see check_writable), is none of the inputs, and no two of them are
/// one file, whatever their names: files that there are compare by identity. Call it before the work, and
/// make_folders after it.
Expected<void> check_outputs(std::span<const std::filesystem::path> outputs,
                             std::span<const std::filesystem::path> inputs);

}  // namespace penumbra
