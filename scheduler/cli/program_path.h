// Where the other executables are, and which builds of them.
#pragma once

#include <filesystem>
#include <string>

#include "kernels/host/error.h"

namespace penumbra {

/// The executable `name` beside this one, else the first in PATH. Error: it is in neither.
Expected<std::filesystem::path> find_program(const std::string& name);

/// Stands for the program's build: what another build rendered is not this one's.
std::string program_hash(const std::filesystem::path& program);

}  // namespace penumbra
