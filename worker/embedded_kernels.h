// Files that are embedded in the binary, such as the portable kernel sources, so that a worker needs none.
#pragma once

#include <span>
#include <string_view>

namespace penumbra {

struct EmbeddedFile {
  std::string_view name;  ///< as in an #include: "kernels/block/block.h"
  std::string_view text;
};

/// The portable kernel sources.
std::span<const EmbeddedFile> embedded_kernels();

/// The text of the file of that name; empty if there is none.
inline std::string_view text_of(std::span<const EmbeddedFile> files, std::string_view name) {
  for (const EmbeddedFile& file : files)
    if (file.name == name) return file.text;
  return {};
}

}  // namespace penumbra
