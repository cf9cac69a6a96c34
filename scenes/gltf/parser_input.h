// A glTF file's JSON as tinygltf gets it: without what is read here, and without what it wrongly refuses.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "scenes/diagnostic.h"

namespace penumbra::gltf {

struct BufferEntry {
  std::string uri{};  ///< empty: the binary part of a GLB file, or nothing
  std::size_t bytes = 0;
};
struct ImageEntry {
  std::string name{}, uri{}, media_type{};
  int view = -1;  ///< none: -1
};

/// What is left to the parser, and what is not.
struct ParserInput {
  std::string text;
  std::vector<BufferEntry>
      buffers{};  ///< tinygltf knows few types of data, and wants files of exactly their length
  std::vector<ImageEntry> images{};  ///< those that nothing shows are never read
  bool has_animations = false;       ///< not read at all
  /// Accessors of indices without a buffer view, which get one that is the last: tinygltf holds them for an
  /// error, compressed and sparse meshes have them.
  std::vector<std::size_t> without_view{};
};

/// Of a text that check_json found good. Errors, with their place: another version than glTF 2, values of the
/// wrong kind.
Expected<ParserInput> parser_input(const SourceFile& json);

}  // namespace penumbra::gltf
