// What is asked of names: the one place where their spellings are made alike, and their longest.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra {

/// toWorld, to_world → to_world; intIOR → int_ior; B → b.
std::string to_snake_case(std::string_view name);

/// A to Z as a to z, whatever the locale.
std::string to_lower_case(std::string_view text);

/// ".exr" of "a.EXR"; empty where there is none, as of ".exr".
std::string extension_of(const std::filesystem::path& path);

/// Bytes that the name of an object, shape or material may have: scenes hold each in several places.
constexpr std::size_t kMaxNameBytes = 1024;

/// An error for a longer one; `kind` is "id", "name of a material".
Expected<void> check_name_length(std::string_view kind, std::string_view name);

/// Whether it is what readers call something that has no name in its file, for messages: "TYPE at
/// FILE:LINE:COLUMN", perhaps with a part's name in brackets.
bool is_place_name(std::string_view name);

}  // namespace penumbra
