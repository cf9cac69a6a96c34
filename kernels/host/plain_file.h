// Reading a whole file whose name comes from outside: never a device, a pipe or more than was expected.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "kernels/host/error.h"

namespace penumbra {

/// All bytes of the file. Errors: not there, not a plain file (a device or a pipe might never end), larger
/// than `max_bytes`, unreadable.
Expected<std::string> read_plain_file(const std::filesystem::path& file, std::uint64_t max_bytes);

}  // namespace penumbra
