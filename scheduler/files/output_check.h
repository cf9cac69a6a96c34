// Checks a command's outputs against its inputs.
#pragma once

#include <sys/stat.h>

#include <compare>
#include <filesystem>
#include <optional>
#include <span>

#include "kernels/host/error.h"

namespace penumbra {

/// Equal for two paths of the same file. For a file that does not exist yet it is the normalised path.
struct FileIdentity {
  dev_t device = 0;
  ino_t number = 0;
  std::filesystem::path path;
  auto operator<=>(const FileIdentity&) const = default;
};

/// Of the file that is written if an output has this path: symbolic links are followed. Nothing for a device
/// or a pipe, to which several outputs may go.
std::optional<FileIdentity> identity_of_output(const std::filesystem::path& output);

/// Checks that every output can be written (see check_writable), that none is an input, and that no two are
/// the same file; existing files are compared by identity, not by name. Call it before the work, and
/// make_folders after it.
Expected<void> check_outputs(std::span<const std::filesystem::path> outputs,
                             std::span<const std::filesystem::path> inputs);

/// Whether the output is one of the inputs, compared by identity.
bool is_among(const std::filesystem::path& output, std::span<const std::filesystem::path> inputs);

}  // namespace penumbra
