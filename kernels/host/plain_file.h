// Reading a whole file whose name comes from outside: never a device, a pipe or more than was expected. And
// writing to one that is open.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "kernels/host/error.h"

namespace penumbra {

/// All bytes of the file. Errors: not there, not a plain file (a device or a pipe might never end), larger
/// than `max_bytes`, unreadable.
Expected<std::string> read_plain_file(const std::filesystem::path& file, std::uint64_t max_bytes);

/// Writes all of it to an open plain file; false with errno set.
bool write_whole(int descriptor, std::span<const std::uint8_t> bytes);

}  // namespace penumbra
