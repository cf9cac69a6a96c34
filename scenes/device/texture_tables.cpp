#include "scenes/device/texture_tables.h"

#include <algorithm>
#include <bit>
#include <climits>
#include <cmath>
#include <cstring>

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
                             std::span<const int> others, std::span<const std::uint32_t> earlier) {
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
  tables.earlier_texels = !earlier.empty() && texels.equals(earlier);
  if (!tables.earlier_texels) tables.texels = texels.take();
  tables.places = std::move(places);
  return tables;
}

void TexelTable::place(const BitmapTexture& texture, TextureNode& node) {
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

int TexelTable::append(Words words) {
  const auto place = int(end_);
  parts_.push_back(words);
  end_ += words.size();
  return place;
}

int TexelTable::place_bitmap(int index) {
  const auto [place, is_new] = places_.try_emplace(index);
  if (is_new) place->second = append(bitmaps_[std::size_t(index)]->words);
  return place->second;
}

int TexelTable::place_decoding(int values, float gamma) {
  const auto [place, is_new] = decodings_.try_emplace({values, gamma});
  if (is_new) {
    std::vector<std::uint32_t>& words = decoded_.emplace_back();
    for (int n = 0; n < values; ++n)
      words.push_back(std::bit_cast<std::uint32_t>(decoded_value(n, values - 1, gamma)));
    place->second = append(words);
  }
  return place->second;
}

bool TexelTable::equals(std::span<const std::uint32_t> table) const {
  if (table.size() != size()) return false;
  for (const Words part : parts_) {
    if (std::memcmp(part.data(), table.data(), part.size_bytes()) != 0) return false;
    table = table.subspan(part.size());
  }
  return table.empty() || table[0] == 0;
}

std::vector<std::uint32_t> TexelTable::take() const {
  std::vector<std::uint32_t> words;
  words.reserve(size());
  for (const Words part : parts_) words.insert(words.end(), part.begin(), part.end());
  words.resize(size());
  return words;
}

}  // namespace penumbra
