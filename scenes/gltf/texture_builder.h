// Converts glTF textures to textures of a scene.
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
  int index = -1;                ///< -1: none
  int texcoord = 0;              ///< the set of texture coordinates
  glm::dmat3 to_uv{1.0};         ///< KHR_texture_transform
  SourceLocation location = {};  ///< for messages
  [[nodiscard]] bool there() const { return index >= 0; }
};

/// The texture that a textureInfo refers to: its index, its set of coordinates, and its extensions.
TextureUse texture_use(int index, int texcoord, const tinygltf::ExtensionMap& extensions,
                       SourceLocation location);

/// The transform u' = c sx u + s sy v + ox, v' = -s sx u + c sy v + oy, where v points down. Scale is applied
/// first, then the rotation, whose direction is the one with which the extension's example shows the lower
/// left quadrant.
glm::dmat3 texture_transform(glm::dvec2 offset, double rotation, glm::dvec2 scale);

class TextureBuilder {
 public:
  TextureBuilder(const Asset& asset, const FileAccess& files, ReaderReport& report, SceneDescription& scene)
      : asset_(asset), bitmaps_(files), report_(report), scene_(scene) {}

  /// The index of a texture of the image's colours (decoded from sRGB), or of one of its channels (linear).
  /// Nothing, and an error, if there is no image.
  std::optional<int> colours(const TextureUse& use);
  std::optional<int> channel(const TextureUse& use, BitmapChannels channel);

  /// The image's alpha channel; nothing if it has none. cut_alpha is 1 where `factor` times alpha is at least
  /// `cutoff`, else 0.
  std::optional<int> alpha(const TextureUse& use);
  std::optional<int> cut_alpha(const TextureUse& use, double factor, double cutoff);

  /// The image as vectors 2 t - 1.
  std::optional<int> vectors(const TextureUse& use);

  /// The image as a normal map, with x and y multiplied by `scale`, and y negated if it is `mirrored`.
  std::optional<int> normals(const TextureUse& use, double scale, bool mirrored);

  /// The colours of the vertices, times a texture or kNoTexture.
  int vertex_colours(int times);

  /// 1 - `factor` times the image's alpha channel, the glossiness; nothing if it has none.
  std::optional<int> roughness_of(const TextureUse& glossiness, double factor);

  /// A texture times a colour.
  int scaled(int texture, const glm::vec3& factor);
  /// The product of two textures, of which the first may be kNoTexture. The second is older than whatever the
  /// first is made of. The first is changed.
  int product(int texture, int by);

  /// Moves the bitmaps to the scene.
  void install() { scene_.bitmaps = bitmaps_.take(); }

 private:
  std::optional<int> bitmap(const TextureUse& use, BitmapChannels channels);
  int add(const TextureUse& use, int bitmap, float gamma, BitmapChannels channels);
  /// The index of a texture's image, from whichever extension provides it; -1: none that can be read.
  [[nodiscard]] int source_of(const TextureUse& use) const;
  std::string name_of(const TextureUse& use) const;

  const Asset& asset_;
  BitmapFiles bitmaps_;
  ReaderReport& report_;
  SceneDescription& scene_;
  std::map<std::tuple<int, double, bool>, int> changed_normals_;  ///< keyed by bitmap, scale, and mirroring
  std::map<std::tuple<int, double, double>, int> cut_bitmaps_;    ///< keyed by bitmap, factor and cutoff
};

}  // namespace penumbra::gltf
