// A glTF file as it is parsed, with the bytes of its images and the places of its values.
#pragma once

#include <tiny_gltf.h>

#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "scenes/file_access.h"
#include "scenes/gltf/json_places.h"

namespace penumbra::gltf {

struct Asset {
  std::unique_ptr<SourceFile> json;  ///< of a GLB file its JSON chunk
  tinygltf::Model model;
  std::map<int, std::string> images;  ///< contents of those that are not in a buffer, by index

  [[nodiscard]] SourceLocation place(std::initializer_list<JsonStep> path) const {
    return json_place(*json, path);
  }
  /// The bytes of a buffer view. Errors: no such view, one that is not within its buffer.
  [[nodiscard]] Expected<std::string_view> view(int index) const;
  /// The contents of an image's file. Errors: not there, as above.
  [[nodiscard]] Expected<std::string_view> image(int index) const;
};

/// Parses a .gltf or .glb file and reads the files that it names through `files`. Errors, with their place:
/// not JSON, not glTF 2, values of the wrong kind, files that are not there or too short.
Expected<std::unique_ptr<Asset>> read_asset(const std::filesystem::path& file, const FileAccess& files);

}  // namespace penumbra::gltf
