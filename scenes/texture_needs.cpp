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
    if (std::holds_alternative<ScaleTexture>(each.model)) return;
    needs.coordinates = true;
    if (std::ranges::find(needs.mapped, texture) == needs.mapped.end()) needs.mapped.push_back(texture);
  } else if (std::ranges::find(needs.attributes, colours->attribute) == needs.attributes.end()) {
    needs.attributes.push_back(colours->attribute);
  }
}

void add_needs_of_bsdf(const SceneDescription& scene, int bsdf, TextureNeeds& needs) {
  if (bsdf < 0) return;  // black, or no BSDF
  const Bsdf& each = scene.bsdfs[std::size_t(bsdf)];
  add_needs(scene, each.bend.texture, needs);
  add_needs(scene, each.turn.texture, needs);
  if (each.coat_bend) add_needs(scene, each.coat_bend->texture, needs);
  std::visit(
      [&](const auto& model) {
        using Model = std::remove_cvref_t<decltype(model)>;
        Model::parameters([&](const char*, auto member, const auto&, const char*) {
          if constexpr (kMayBeTexture<std::remove_cvref_t<decltype(model.*member)>>)
            add_needs(scene, (model.*member).texture, needs);
        });
        if constexpr (std::is_same_v<Model, MaskBsdf>) add_needs_of_bsdf(scene, model.inside, needs);
        if constexpr (std::is_same_v<Model, BlendBsdf>)
          for (const int child : {model.first, model.second}) add_needs_of_bsdf(scene, child, needs);
      },
      each.model);
}

}  // namespace

TextureNeeds texture_needs(const SceneDescription& scene, const Shape& shape) {
  TextureNeeds needs;
  add_needs_of_bsdf(scene, shape.front_bsdf, needs);
  add_needs_of_bsdf(scene, shape.back_bsdf, needs);
  add_needs(scene, shape.radiance_texture, needs);
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
