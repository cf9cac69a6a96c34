// The one place where spellings of names are made alike.
#pragma once

#include <string>
#include <string_view>

namespace penumbra {

/// toWorld, to_world → to_world; intIOR → int_ior; B → b.
std::string to_snake_case(std::string_view name);

}  // namespace penumbra
