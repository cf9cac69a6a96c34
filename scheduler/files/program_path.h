// Finds the other executables and identifies their builds.
#pragma once

#include <filesystem>
#include <string>

#include "kernels/host/error.h"

namespace penumbra {

/// The executable `name` beside this one, else the first in PATH. Error: it is in neither.
Expected<std::filesystem::path> find_program(const std::string& name);

/// A hash that identifies the program's build. Results of another build must not be mixed with this one's.
std::string program_hash(const std::filesystem::path& program);

}  // namespace penumbra
