// A glTF file as it is parsed, with its buffers, its images and the places of its values.
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
  explicit Asset(const FileAccess& files_of_scene) : files(files_of_scene) {}

  const FileAccess& files;
  std::unique_ptr<SourceFile> json = std::make_unique<SourceFile>();  ///< of a GLB file its JSON chunk
  tinygltf::Model model{};
  bool has_animations = false;

  [[nodiscard]] SourceLocation place(std::initializer_list<JsonStep> path) const {
    return json_place(*json, path);
  }
  /// The bytes of a buffer view, unpacked where they are compressed. Errors: no such view, one that is not
  /// within its buffer, compressed data that are damaged.
  [[nodiscard]] Expected<std::string_view> view(int index) const;
  /// The contents of an image's file. Errors: not there, as above.
  [[nodiscard]] Expected<std::string_view> image(int index) const;

 private:
  [[nodiscard]] Expected<std::string_view> part(int buffer, std::size_t offset, std::size_t length,
                                                std::string_view name) const;
  [[nodiscard]] Expected<std::string> unpacked(const tinygltf::Value& compression, int index) const;

  mutable std::map<int, Expected<std::string>> images_{};    ///< of those in files and addresses, by index
  mutable std::map<int, Expected<std::string>> unpacked_{};  ///< of views that are compressed, by index
};

/// Parses a .gltf or .glb file and reads the files that it names through `files`. Errors, with their place:
/// not JSON, not glTF 2, values of the wrong kind, buffers that are not there or too short.
Expected<std::unique_ptr<Asset>> read_asset(const std::filesystem::path& file, const FileAccess& files);

/// The file that an address names, beside the asset or in folders from there.
Expected<std::filesystem::path> find_file(const Asset& asset, std::string_view address);

}  // namespace penumbra::gltf
