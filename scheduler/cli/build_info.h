// Build configuration of this program, for bug reports.
#pragma once

#include <string>

namespace penumbra {

/// Lines for `penumbra --version`: version and commit, compiler, instruction sets, backends, libraries.
std::string build_info();

}  // namespace penumbra
