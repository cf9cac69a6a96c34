// Reads a whole file whose name is untrusted: never a device, a pipe or more bytes than expected. Also writes
// to an open file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "kernels/host/error.h"

namespace penumbra {

/// All bytes of the file. Errors: it does not exist, is not a regular file (a device or a pipe might never
/// end), is larger than `max_bytes`, or cannot be read.
Expected<std::string> read_plain_file(const std::filesystem::path& file, std::uint64_t max_bytes);

/// Of a file that does not exist: "; did you mean 'x'?" with the path whose misspelt part is replaced by the
/// nearest name in its folder, or empty.
std::string file_suggestion(const std::filesystem::path& file);

/// Writes all bytes to an open file or pipe. Returns false, with errno set, on failure.
bool write_whole(int descriptor, std::span<const std::uint8_t> bytes);

}  // namespace penumbra
