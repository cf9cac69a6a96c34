// The portable kernel sources, embedded in the binary so that a worker needs no files.
#pragma once

#include <span>
#include <string_view>

namespace penumbra {

struct EmbeddedFile {
  std::string_view name;  ///< as in an #include: "kernels/block/block.h"
  std::string_view text;
};

std::span<const EmbeddedFile> embedded_kernels();

}  // namespace penumbra
