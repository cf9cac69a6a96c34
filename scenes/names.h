// What is asked of names: the one place where their spellings are made alike, and their longest.
#pragma once

#include <string>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra {

/// toWorld, to_world → to_world; intIOR → int_ior; B → b.
std::string to_snake_case(std::string_view name);

/// Bytes that the name of an object, shape or material may have: scenes hold each in several places.
constexpr std::size_t kMaxNameBytes = 1024;

/// An error for a longer one; `kind` is "id", "name of a material".
Expected<void> check_name_length(std::string_view kind, std::string_view name);

}  // namespace penumbra
