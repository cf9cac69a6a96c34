// Prepares a glTF file's JSON for tinygltf. Parts that are read here are removed, as are parts that tinygltf
// wrongly rejects.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "scenes/diagnostic.h"

namespace penumbra::gltf {

struct BufferEntry {
  std::string uri{};  ///< empty: the binary chunk of a GLB file, or none
  std::size_t bytes = 0;
};
struct ImageEntry {
  std::string name{}, uri{}, media_type{};
  int view = -1;  ///< -1: none
};

/// An animation as the file has it. Indices may lead nowhere.
struct AnimationEntry {
  struct Sampler {
    int input = -1, output = -1;  ///< accessors
    std::string interpolation = "LINEAR";
  };
  struct Channel {
    int sampler = -1;
    int node = -1;          ///< -1: none
    std::string path{};     ///< "translation", for example
    std::string pointer{};  ///< of KHR_animation_pointer; else empty
  };
  std::string name{};
  std::vector<Sampler> samplers{};
  std::vector<Channel> channels{};
};

/// The JSON for the parser, and what was removed from it.
struct ParserInput {
  std::string text;
  std::vector<BufferEntry>
      buffers{};  ///< tinygltf supports few media types, and requires files of exactly the stated length
  std::vector<ImageEntry> images{};          ///< images that no texture uses are never read
  std::vector<AnimationEntry> animations{};  ///< the parser requires targets that are nodes
  /// Index accessors without a buffer view. They occur in compressed and sparse meshes, but tinygltf rejects
  /// them. Here they get an additional buffer view, the last one.
  std::vector<std::size_t> without_view{};
};

/// The text must have passed check_json. Errors, with their location: another version than glTF 2, values of
/// the wrong type.
Expected<ParserInput> parser_input(const SourceFile& json);

}  // namespace penumbra::gltf
