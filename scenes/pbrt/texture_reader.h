// Reads the textures of pbrt.
#pragma once

#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "scenes/image/bitmap_files.h"
#include "scenes/pbrt/colours.h"
#include "scenes/pbrt/state.h"
#include "scenes/pbrt/texture_mapping.h"

namespace penumbra::pbrt {

class TextureReader {
 public:
  explicit TextureReader(Context& context) : context_(context), bitmaps_(context.files) {}

  /// Reads the directive Texture "name" "float|spectrum" "class".
  void read(const std::string& name, const std::string& kind, const std::string& type, Parameters parameters,
            const glm::dmat4& ctm, SourceLocation location);

  /// The value of a parameter that may be a texture, or `fallback` if it is not given.
  TexturedColour colour(Parameters& parameters, std::string_view name, ColourOf use,
                        const glm::vec3& fallback);
  TexturedNumber number(Parameters& parameters, std::string_view name, double fallback, double low,
                        double high);

  /// The square root of a texture, and a texture times a colour. The square root exists only for images and
  /// checkerboards, possibly scaled.
  std::optional<int> square_root(int texture);
  int scaled(int texture, const glm::vec3& factor);
  /// An image of colours, possibly scaled, by a function of its texels. Nothing for other textures.
  std::optional<int> of_texels(int texture, const std::function<glm::dvec3(const glm::dvec3&)>& of);
  /// A light's image by the film's white balance.
  int balanced(int light_image);
  /// A light's image, or kNoTexture, times an alpha. Nothing if they are not two images that are mapped
  /// alike.
  std::optional<int> product(int light_image, int alpha);

  /// An image whose values are radiance.
  std::optional<int> light_image(const std::string& file, SourceLocation location);
  /// Adds a computed image of linear values.
  int made_image(const std::string& name, Bitmap bitmap);
  [[nodiscard]] const Bitmap& bitmap_of(int texture) const;

  /// The image of a normal map.
  std::optional<int> normal_map(const std::string& file, SourceLocation location);
  std::shared_ptr<const Bitmap> image(const std::string& file, SourceLocation location);

  /// The mapping of a texture; null: by texture coordinates.
  [[nodiscard]] const TextureMapping* mapping_of(int texture) const;

  void install() { context_.scene.bitmaps = bitmaps_.take(); }

 private:
  TextureValue imagemap(Parameters& parameters, SourceLocation location);
  TextureValue scale(Parameters& parameters, SourceLocation location);
  TextureValue mix(Parameters& parameters, SourceLocation location);
  TextureValue direction_mix(Parameters& parameters, SourceLocation location);
  TextureValue checkerboard(Parameters& parameters, SourceLocation location);
  TextureValue dots(Parameters& parameters, SourceLocation location);
  TextureValue bilerp(Parameters& parameters, SourceLocation location);
  TextureValue fbm(Parameters& parameters, SourceLocation location);
  /// Whether a texture has numbers or colours as values.
  enum class Of { kNumbers, kColours };
  TextureValue value(Parameters& parameters, std::string_view name, double fallback, Of of);
  TextureValue value(Parameters& parameters, std::string_view name, double fallback) {
    return value(parameters, name, fallback, of_);
  }
  /// The image of a function applied to textures. They must be images that differ only in their texels;
  /// otherwise nothing. `any_wrap`: they may repeat in other ways, and the last one's counts.
  std::optional<TextureValue> combined(std::initializer_list<TextureValue> values,
                                       const std::function<glm::dvec3(std::span<const glm::dvec3>)>& of,
                                       bool any_wrap = false);
  /// The transform from texture coordinates, or from those of the current texture's mapping, to those of
  /// pbrt's images.
  glm::dmat3 mapping(Parameters& parameters, SourceLocation location);
  int add(std::string name, TextureModel model, const glm::dmat3& to_uv = glm::dmat3(1.0));
  int add_mapped(TextureModel model, const glm::dmat3& to_uv);
  TextureValue placeholder(SourceLocation location, const std::string& message);
  std::optional<int> bitmap(const std::string& file, SourceLocation location);
  /// The alpha channel of an image of colours, which is its value as a float texture. Nothing if alpha is 1
  /// everywhere.
  std::optional<int> alpha_of(const std::string& file);
  /// The value of an image of colours as a float texture: their mean. Nothing for an image of greys.
  std::optional<int> mean_of(int bitmap, float gamma);

  Context& context_;
  BitmapFiles bitmaps_;
  std::map<std::pair<std::string, Of>, TextureValue> textures_;
  std::map<int, std::optional<int>> square_roots_;
  std::map<std::pair<int, float>, std::optional<int>> means_;
  std::map<std::pair<int, int>, std::optional<int>> products_;
  std::map<int, TextureMapping> mappings_;
  std::optional<TextureMapping> mapping_;  ///< of the texture that is being read
  glm::dmat4 ctm_{1.0};                    ///< of the texture that is being read
  std::string name_;                       ///< of the texture that is being read
  Of of_ = Of::kColours;
};

}  // namespace penumbra::pbrt
