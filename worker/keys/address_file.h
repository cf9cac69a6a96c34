// A file in which a scheduler tells its workers where it is, for a scheduler that a job queue starts on a
// host that nobody knows before. Workers are given "file:PATH" for its address.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "kernels/host/error.h"

namespace penumbra {

/// The path of "file:PATH"; empty for other addresses.
std::filesystem::path address_file_of(const std::string& address);

/// What a scheduler writes: the address ("host:port" or "unix:path") at which workers reach it.
Expected<void> write_address_file(const std::filesystem::path& file, const std::string& address);

/// What a scheduler does at its end. If another one follows and goes on with the render (`comes_back`), the
/// file is removed; else it says that the render has ended, so that workers that start later do not wait.
Expected<void> end_address_file(const std::filesystem::path& file, bool comes_back);

/// The address in the file; nothing if the render has ended. Errors, all of which may pass: there is no file
/// yet, it cannot be read, there is no address in it.
Expected<std::optional<std::string>> read_address_file(const std::filesystem::path& file);

}  // namespace penumbra
