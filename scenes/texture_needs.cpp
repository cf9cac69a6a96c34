#include "scenes/texture_needs.h"

#include <algorithm>

namespace penumbra {
namespace {

void add_needs(const SceneDescription& scene, int texture, TextureNeeds& needs) {
  if (texture < 0) return;
  const SceneTexture& each = scene.textures[std::size_t(texture)];
  const TextureNode node = texture_of(each);
  add_needs(scene, node.texture0, needs);
  add_needs(scene, node.texture1, needs);
  const auto* colours = std::get_if<MeshAttributeTexture>(&each.model);
  if (colours == nullptr) {
    needs.coordinates = needs.coordinates || !std::holds_alternative<ScaleTexture>(each.model);
  } else if (std::ranges::find(needs.attributes, colours->attribute) == needs.attributes.end()) {
    needs.attributes.push_back(colours->attribute);
  }
}

void add_needs_of_bsdf(const SceneDescription& scene, int bsdf, TextureNeeds& needs) {
  if (bsdf == kBlackBsdf) return;
  const Material material = material_of(scene.bsdfs[std::size_t(bsdf)]);
#define ADD_NEEDS(_, type, name) add_needs(scene, material.name##_texture, needs);
  TEXTURED_FIELDS(ADD_NEEDS, )
#undef ADD_NEEDS
}

}  // namespace

TextureNeeds texture_needs(const SceneDescription& scene, const Shape& shape) {
  TextureNeeds needs;
  add_needs_of_bsdf(scene, shape.front_bsdf, needs);
  add_needs_of_bsdf(scene, shape.back_bsdf, needs);
  return needs;
}

TextureNeeds missing_for_textures(const SceneDescription& scene, const Shape& shape) {
  TextureNeeds missing = texture_needs(scene, shape);
  const auto* mesh = std::get_if<Mesh>(&shape.geometry);
  missing.coordinates = missing.coordinates && mesh != nullptr && mesh->texcoords.empty();
  std::erase_if(missing.attributes, [&](MeshAttribute attribute) {
    return mesh != nullptr &&
           !(attribute == MeshAttribute::kVertexColour ? mesh->colours : mesh->face_colours).empty();
  });
  return missing;
}

}  // namespace penumbra
