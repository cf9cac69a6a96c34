#include "scenes/device/texture_tables.h"

#include <algorithm>

#include "scenes/device/texel_table.h"

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

}  // namespace penumbra
