// Reads <texture> objects as textures of a scene.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "scenes/image/bitmap_files.h"
#include "scenes/image/bitmap_values.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/textures.h"

namespace penumbra::mitsuba {

/// An image and the decoding of its values.
struct TextureImage {
  std::shared_ptr<const Bitmap> bitmap;  ///< null: no image
  float gamma = kSrgb;                   ///< for integers, see decoded_value
  float scale = 1.0f;                    ///< multiplies the values
};

/// Whether the parameter is a colour or a number.
enum class TextureUse { kColour, kNumber };

class TextureReader {
 public:
  TextureReader(const Context& context, const FileAccess& files)
      : context_(context), files_(files), bitmaps_(files) {}

  /// The index of the texture, which is added if it is new. Problems are reported once; then it has no index.
  std::optional<int> read(const Object& object, TextureUse use = TextureUse::kColour);

  /// The image to which the plugin's `filename` refers. Null after an error (or, in lenient mode, a warning)
  /// if it cannot be read.
  std::shared_ptr<const Bitmap> read_image(PluginReader& plugin, const std::string& filename);

  /// The image of a texture whose texels are needed: a bitmap, possibly inside scale textures. No image for
  /// other textures, or if read_image fails.
  TextureImage read_texture_image(const Object& object);

  /// Moves all textures and bitmaps to the scene.
  void install(SceneDescription& scene);

 private:
  friend struct TexturePlugins;
  bool begin(const Object& object);
  std::optional<SceneTexture> read_new(const Object& object, TextureUse use);

  std::optional<TextureModel> read_model(PluginReader& plugin, BitmapTexture model);
  std::optional<TextureModel> read_model(PluginReader& plugin, ScaleTexture model);
  std::optional<TextureModel> read_model(PluginReader& plugin, MeshAttributeTexture model);
  template <typename Model>
  std::optional<TextureModel> read_model(PluginReader& plugin, Model model) {
    plugin.read_parameters(model);
    return model;
  }
  template <typename Model>
  static std::optional<TextureModel> read_as(TextureReader& reader, PluginReader& plugin) {
    return reader.read_model(plugin, Model{});
  }
  std::optional<TextureModel> without_bitmap(PluginReader& plugin, const std::string& message);
  void report(PluginReader& plugin, const BitmapTexture& model, const BitmapFindings& findings);

  const Context& context_;
  const FileAccess& files_;
  BitmapFiles bitmaps_;
  std::map<std::pair<const Object*, TextureUse>, std::optional<int>> known_;
  TextureUse use_ = TextureUse::kColour;  ///< of the texture that is being read
  std::set<const Object*> reading_;
  std::vector<SceneTexture> textures_;
};

}  // namespace penumbra::mitsuba
