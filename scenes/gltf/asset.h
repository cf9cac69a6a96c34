// A parsed glTF file with its buffers, its images and the locations of its values.
#pragma once

#include <tiny_gltf.h>

#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/file_access.h"
#include "scenes/gltf/json_places.h"
#include "scenes/gltf/parser_input.h"

namespace penumbra::gltf {

struct Asset {
  explicit Asset(const FileAccess& files_of_scene) : files(files_of_scene) {}

  const FileAccess& files;
  /// The file's text; for a GLB file its JSON chunk.
  std::unique_ptr<SourceFile> json = std::make_unique<SourceFile>();
  tinygltf::Model model{};
  std::vector<AnimationEntry> animations{};

  [[nodiscard]] SourceLocation place(std::initializer_list<JsonStep> path) const {
    return json_place(*json, path);
  }
  /// The bytes of a buffer view, decompressed if necessary. Errors: no such view, a view outside its buffer,
  /// damaged compressed data.
  [[nodiscard]] Expected<std::string_view> view(int index) const;
  /// The contents of an image file. Errors: no such image; those of view().
  [[nodiscard]] Expected<std::string_view> image(int index) const;

 private:
  [[nodiscard]] Expected<std::string_view> part(int buffer, std::size_t offset, std::size_t length,
                                                std::string_view name) const;
  [[nodiscard]] Expected<std::string> unpacked(const tinygltf::Value& compression, int index) const;

  mutable std::map<int, Expected<std::string>> images_{};    ///< images in files and data addresses, by index
  mutable std::map<int, Expected<std::string>> unpacked_{};  ///< decompressed buffer views, by index
};

/// Parses a .gltf or .glb file and reads the files that it refers to through `files`. Errors, with their
/// location: not JSON, not glTF 2, values of the wrong type, buffers that are missing or too short.
Expected<std::unique_ptr<Asset>> read_asset(const std::filesystem::path& file, const FileAccess& files);

/// The file that a URI refers to, relative to the asset's folder.
Expected<std::filesystem::path> find_file(const Asset& asset, std::string_view address);

}  // namespace penumbra::gltf
