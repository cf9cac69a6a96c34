// Where in a JSON text its values are, for messages: parsers of JSON do not say.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string_view>
#include <variant>

#include "scenes/diagnostic.h"

namespace penumbra::gltf {

/// A member's name or an element's index.
using JsonStep = std::variant<std::string_view, std::size_t>;

/// The value that is reached by these steps from the root, or as far as they lead. The text is known to be
/// well-formed.
SourceLocation json_place(const SourceFile& file, std::initializer_list<JsonStep> path);

/// Errors, with their place: not JSON, or nested more than 64 deep, which recursive readers would not
/// survive.
Expected<void> check_json(const SourceFile& file);

}  // namespace penumbra::gltf
