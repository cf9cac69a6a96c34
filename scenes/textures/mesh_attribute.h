// Colours stored with a mesh.
#pragma once

#include "scenes/plugin_values.h"
#include "scenes/textured.h"

namespace penumbra {

enum class MeshAttribute { kVertexColour, kFaceColour };

inline OneOf<MeshAttribute> mesh_attributes() {
  return {{{"vertex_color", MeshAttribute::kVertexColour}, {"face_color", MeshAttribute::kFaceColour}}};
}

struct MeshAttributeTexture {
  static constexpr const char* kPlugin = "mesh_attribute";
  static constexpr const char* kText = "colours of the vertices or faces of a mesh";
  MeshAttribute attribute = MeshAttribute::kVertexColour;
  float scale = 1.0f;
  int times = kNoTexture;  ///< another texture, which multiplies it

  template <typename Row>
  static void parameters(const Row& row) {
    row("name", &MeshAttributeTexture::attribute, mesh_attributes(), "which colours");
    row("scale", &MeshAttributeTexture::scale, NumberWithin{LowEnd::kClosed, 0.0f, kAnyNumber},
        "by which they are multiplied");
  }
};

/// The record without its index among the colours of a triangle.
inline TextureNode texture_of(const MeshAttributeTexture& texture) {
  TextureNode t{};
  t.kind = TEXTURE_MESH_ATTRIBUTE;
  t.texture0 = texture.times;
  t.texture1 = kNoTexture;
  t.colour0 = to_vec3(glm::vec3(texture.scale));
  return t;
}

}  // namespace penumbra
