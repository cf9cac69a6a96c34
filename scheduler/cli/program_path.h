// Where the other executables are.
#pragma once

#include <filesystem>
#include <string>

#include "kernels/host/error.h"

namespace penumbra {

/// The executable `name` beside this one, else the first in PATH. Error: it is in neither.
Expected<std::filesystem::path> find_program(const std::string& name);

}  // namespace penumbra
