#include "scenes/device/texture_tables.h"

#include <algorithm>
#include <bit>
#include <climits>
#include <cmath>

namespace penumbra {
namespace {

int place_of(MeshAttribute attribute, std::vector<MeshAttribute>& attributes) {
  const auto found = std::ranges::find(attributes, attribute);
  const int index = int(found - attributes.begin());
  if (found == attributes.end()) attributes.push_back(attribute);
  return index;
}

}  // namespace

TextureTables texture_tables(const SceneDescription& scene, std::span<Material> materials,
                             std::span<const int> others) {
  // First whether each texture is in the table, then its index there.
  std::vector<int> places(scene.textures.size(), kNoTexture);
  const auto use = [&](int texture) {
    if (texture >= 0) places[std::size_t(texture)] = 0;
  };
  for (const Material& material : materials) {
#define USE_TEXTURE(_, type, name) use(material.name##_texture);
    MATERIAL_TEXTURES(USE_TEXTURE, )
#undef USE_TEXTURE
  }
  for (const int texture : others) use(texture);
  // A texture refers only to textures with smaller indices.
  for (std::size_t i = places.size(); i-- > 0;) {
    if (places[i] == kNoTexture) continue;
    const TextureNode node = texture_of(scene.textures[i]);
    use(node.texture0);
    use(node.texture1);
  }
  TextureTables tables;
  TexelTable texels(scene.bitmaps);
  for (std::size_t i = 0; i < places.size(); ++i)
    if (const auto* bitmap = std::get_if<BitmapTexture>(&scene.textures[i].model);
        bitmap != nullptr && places[i] != kNoTexture)
      texels.expect(*bitmap);
  const auto replace = [&](int& texture) {
    if (texture >= 0) texture = places[std::size_t(texture)];
  };
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] == kNoTexture) continue;
    places[i] = int(tables.textures.size());
    TextureNode node = texture_of(scene.textures[i]);
    replace(node.texture0);
    replace(node.texture1);
    const TextureModel& model = scene.textures[i].model;
    if (const auto* bitmap = std::get_if<BitmapTexture>(&model)) texels.place(*bitmap, node);
    if (const auto* colours = std::get_if<MeshAttributeTexture>(&model))
      node.attribute = place_of(colours->attribute, tables.attributes);
    tables.textures.push_back(node);
  }
  for (Material& material : materials) {
#define REPLACE_TEXTURE(_, type, name) replace(material.name##_texture);
    MATERIAL_TEXTURES(REPLACE_TEXTURE, )
#undef REPLACE_TEXTURE
  }
  tables.texels = texels.take();
  tables.places = std::move(places);
  return tables;
}

void TexelTable::expect(const BitmapTexture& texture) {
  if (expected_.insert(texture.bitmap).second)
    expected_words_ += bitmaps_[std::size_t(texture.bitmap)]->words.size();
}

void TexelTable::place(const BitmapTexture& texture, TextureNode& node) {
  constexpr std::size_t kForDecodings = 1 << 17;
  if (words_.empty()) words_.reserve(expected_words_ + kForDecodings);
  const Bitmap& bitmap = *bitmaps_[std::size_t(texture.bitmap)];
  node.kind = bitmap.type == TexelType::kByte    ? TEXTURE_BYTE_BITMAP
              : bitmap.type == TexelType::kShort ? TEXTURE_SHORT_BITMAP
              : bitmap.type == TexelType::kHalf  ? TEXTURE_HALF_BITMAP
                                                 : TEXTURE_FLOAT_BITMAP;
  node.width = bitmap.width;
  node.height = bitmap.height;
  node.channels = bitmap.channels;
  node.decoding = -1;
  if (bitmap.type == TexelType::kByte) node.decoding = place_decoding(256, texture.gamma);
  if (bitmap.type == TexelType::kShort && texture.gamma != 1.0f)
    node.decoding = place_decoding(65536, texture.gamma);
  node.texels = place_bitmap(texture.bitmap);
}

int TexelTable::place_bitmap(int index) {
  const auto [place, is_new] = places_.try_emplace(index, int(words_.size()));
  if (is_new) {
    const std::vector<std::uint32_t>& texels = bitmaps_[std::size_t(index)]->words;
    words_.insert(words_.end(), texels.begin(), texels.end());
  }
  return place->second;
}

int TexelTable::place_decoding(int values, float gamma) {
  const auto [place, is_new] = decodings_.try_emplace({values, gamma}, int(words_.size()));
  if (is_new) {
    for (int n = 0; n < values; ++n)
      words_.push_back(std::bit_cast<std::uint32_t>(decoded_value(n, values - 1, gamma)));
  }
  return place->second;
}

std::vector<std::uint32_t> TexelTable::take() {
  if (!words_.empty()) words_.push_back(0);
  return std::move(words_);
}

}  // namespace penumbra
