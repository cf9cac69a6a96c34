// Textures of pbrt.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "scenes/image/bitmap_files.h"
#include "scenes/pbrt/colours.h"
#include "scenes/pbrt/state.h"

namespace penumbra::pbrt {

class TextureReader {
 public:
  explicit TextureReader(Context& context) : context_(context), bitmaps_(context.files) {}

  /// The directive Texture "name" "float|spectrum" "class".
  void read(const std::string& name, const std::string& kind, const std::string& type, Parameters parameters,
            SourceLocation location);

  /// A parameter that may be a texture; `fallback` where it is not given.
  TexturedColour colour(Parameters& parameters, std::string_view name, ColourOf use,
                        const glm::vec3& fallback);
  TexturedNumber number(Parameters& parameters, std::string_view name, double fallback, double low,
                        double high);

  /// A normal map's image.
  std::optional<int> normal_map(const std::string& file, SourceLocation location);
  std::shared_ptr<const Bitmap> image(const std::string& file, SourceLocation location);

  void install() { context_.scene.bitmaps = bitmaps_.take(); }

 private:
  TextureValue imagemap(Parameters& parameters, SourceLocation location);
  TextureValue scale(Parameters& parameters, SourceLocation location);
  TextureValue mix(Parameters& parameters, SourceLocation location);
  TextureValue checkerboard(Parameters& parameters, SourceLocation location);
  /// Of a texture's own parameter, a number or a colour.
  TextureValue value(Parameters& parameters, std::string_view name, double fallback);
  glm::dmat3 mapping(Parameters& parameters, SourceLocation location);
  int add(std::string name, TextureModel model, const glm::dmat3& to_uv = glm::dmat3(1.0));
  TextureValue stand_in(SourceLocation location, const std::string& message);
  std::optional<int> bitmap(const std::string& file, SourceLocation location);

  Context& context_;
  BitmapFiles bitmaps_;
  std::map<std::string, TextureValue> textures_;
  std::string name_;  ///< of the one that is being read
};

}  // namespace penumbra::pbrt
