// Textures of glTF as textures of a scene.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <tuple>

#include "scenes/gltf/asset.h"
#include "scenes/image/bitmap_files.h"
#include "scenes/reader_report.h"
#include "scenes/scene_description.h"

namespace penumbra::gltf {

/// A texture as a material refers to it.
struct TextureUse {
  int index = -1;                ///< none: -1
  int texcoord = 0;              ///< which set of coordinates
  glm::dmat3 to_uv{1.0};         ///< KHR_texture_transform
  SourceLocation location = {};  ///< for messages
  [[nodiscard]] bool there() const { return index >= 0; }
};

/// Of a textureInfo: its index, its set of coordinates, and its extensions.
TextureUse texture_use(int index, int texcoord, const tinygltf::ExtensionMap& extensions,
                       SourceLocation location);

/// u' = c sx u + s sy v + ox, v' = -s sx u + c sy v + oy: scale first, then the rotation by which the
/// extension's example shows the lower left quadrant, v from the top.
glm::dmat3 texture_transform(glm::dvec2 offset, double rotation, glm::dvec2 scale);

class TextureBuilder {
 public:
  TextureBuilder(const Asset& asset, const FileAccess& files, ReaderReport& report, SceneDescription& scene)
      : asset_(asset), bitmaps_(files), report_(report), scene_(scene) {}

  /// Index of a texture of its colours (sRGB) or of one channel (linear); none, and an error, where there is
  /// no image.
  std::optional<int> colours(const TextureUse& use);
  std::optional<int> channel(const TextureUse& use, BitmapChannels channel);

  /// Whether the image has an alpha channel; its values, and where `factor` times them is at least `cutoff`.
  std::optional<int> alpha(const TextureUse& use);
  std::optional<int> cut_alpha(const TextureUse& use, double factor, double cutoff);

  /// Its normals, x and y times `scale`.
  std::optional<int> normals(const TextureUse& use, double scale);

  /// The textures of KHR_materials_pbrSpecularGlossiness, of which one at least is there, times its factors,
  /// as ones of metal and roughness with the coordinates of the first of them; nothing where none is.
  struct Converted {
    int base_colour = kNoTexture, metallic = kNoTexture, roughness = kNoTexture;
  };
  std::optional<Converted> specular_glossiness(const TextureUse& diffuse, const TextureUse& specular,
                                               const glm::dvec3& diffuse_factor,
                                               const glm::dvec3& specular_factor, double glossiness);

  /// A texture times a colour.
  int scaled(int texture, const glm::vec3& factor);

  /// Moves the bitmaps to the scene.
  void install() { scene_.bitmaps = bitmaps_.take(); }

 private:
  std::optional<int> bitmap(const TextureUse& use, BitmapChannels channels);
  int add(const TextureUse& use, int bitmap, float gamma, BitmapChannels channels);
  /// The image of a texture, of whichever extension; -1: none that is read.
  [[nodiscard]] int source_of(const TextureUse& use) const;
  std::string name_of(const TextureUse& use) const;

  const Asset& asset_;
  BitmapFiles bitmaps_;
  ReaderReport& report_;
  SceneDescription& scene_;
  std::map<std::tuple<int, double>, int> scaled_normals_;       ///< by bitmap and scale
  std::map<std::tuple<int, double, double>, int> cut_bitmaps_;  ///< by bitmap, factor and cutoff
};

}  // namespace penumbra::gltf
