// Names in scene files: spelling variants, maximum length, file extensions.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra {

/// toWorld, to_world → to_world; intIOR → int_ior; B → b.
std::string to_snake_case(std::string_view name);

/// Replaces A to Z by a to z, independent of the locale.
std::string to_lower_case(std::string_view text);

/// The extension in lower case: ".exr" for "a.EXR". Empty if there is none; ".exr" has none.
std::string extension_of(const std::filesystem::path& path);

/// The longest name of an object, shape or material, in bytes. A scene stores each name several times, hence
/// the limit.
constexpr std::size_t kMaxNameBytes = 1024;

/// Error if `name` is longer. `kind` is "id" or "name of a material", for example.
Expected<void> check_name_length(std::string_view kind, std::string_view name);

/// Whether the name is one that readers make up for messages about something unnamed: "TYPE at
/// FILE:LINE:COLUMN", possibly followed by a part's name in brackets.
bool is_place_name(std::string_view name);

}  // namespace penumbra
