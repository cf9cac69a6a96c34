// The sources of gl/shaders/composite*, embedded in the binary.
#pragma once

#include <span>
#include <string_view>

namespace penumbra::composite {

struct EmbeddedFile {
  std::string_view name;  ///< "gl/shaders/composite.vert"
  std::string_view text;
};

std::span<const EmbeddedFile> shader_files();

}  // namespace penumbra::composite
