// Finds the source location of values in a JSON text, for messages. JSON parsers do not report it.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string_view>
#include <variant>

#include "scenes/diagnostic.h"

namespace penumbra::gltf {

/// A member's name or an element's index.
using JsonStep = std::variant<std::string_view, std::size_t>;

/// The location of the value that these steps reach from the root, or as far as they lead. The text must be
/// well-formed.
SourceLocation json_place(const SourceFile& file, std::initializer_list<JsonStep> path);

/// Errors, with their location: not JSON; nested more than 64 deep, which could overflow the stack of
/// recursive readers.
Expected<void> check_json(const SourceFile& file);

}  // namespace penumbra::gltf
