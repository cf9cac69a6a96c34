// Files that appear whole or not at all: a crash, a full disk or a kill leaves the old file or the new one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "kernels/host/error.h"

namespace penumbra {

/// Writes `bytes` to a hidden file beside `path`, flushes it to the disk and renames it to `path`. On an
/// error the old file, if there is one, is untouched and nothing is left behind. Errors: the folder is
/// missing or not writable, the disk is full, `path` is a folder.
Expected<void> write_file_atomically(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

/// Whether `write_file_atomically(path, …)` can be expected to work, found out by creating and removing a
/// hidden file there, so that a render of hours does not end at a missing folder.
Expected<void> check_writable(const std::filesystem::path& path);

}  // namespace penumbra
