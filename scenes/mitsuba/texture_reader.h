// <texture> objects as textures of a scene.
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

/// An image, and what its values count.
struct TextureImage {
  std::shared_ptr<const Bitmap> bitmap;  ///< null: none
  float gamma = kSrgb;                   ///< of whole numbers, see decoded_value
  float scale = 1.0f;                    ///< by which values are multiplied
};

/// What a texture stands for.
enum class TextureUse { kColour, kNumber };

class TextureReader {
 public:
  TextureReader(const Context& context, const FileAccess& files)
      : context_(context), files_(files), bitmaps_(files) {}

  /// Its index among the textures, which it is added to where it is new. What is wrong with it is reported,
  /// once; then there is none.
  std::optional<int> read(const Object& object, TextureUse use = TextureUse::kColour);

  /// The image that the plugin's `filename` names, which is this one; null, and an error or with leniency a
  /// warning, if it cannot be read.
  std::shared_ptr<const Bitmap> read_image(PluginReader& plugin, const std::string& filename);

  /// That of a texture whose texels alone are wanted: a bitmap, or one within scale textures. Without one, as
  /// of read_image, and for other textures.
  TextureImage read_texture_image(const Object& object);

  /// Moves what was read to the scene.
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
  TextureUse use_ = TextureUse::kColour;  ///< of the one that is being read
  std::set<const Object*> reading_;
  std::vector<SceneTexture> textures_;
};

}  // namespace penumbra::mitsuba
