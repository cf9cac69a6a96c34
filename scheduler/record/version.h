// The version of the program, defined by the build.
#pragma once

#include <string_view>

namespace penumbra {

constexpr std::string_view kVersion = PENUMBRA_VERSION;

}  // namespace penumbra
