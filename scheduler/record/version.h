// The version of the program, as the build names it.
#pragma once

#include <string_view>

namespace penumbra {

constexpr std::string_view kVersion = PENUMBRA_VERSION;

}  // namespace penumbra
