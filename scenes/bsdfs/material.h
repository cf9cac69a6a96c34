// What BSDFs become a material with.
#pragma once

#include "kernels/scene_types.h"
#include "scenes/textured.h"

namespace penumbra {

/// A leaf of that family, with 0 for all it has and no textures.
inline Material material_of_family(int family) {
  Material m{};
#define NO_TEXTURE(_, type, name) m.name##_texture = kNoTexture;
  MATERIAL_TEXTURES(NO_TEXTURE, _)
#undef NO_TEXTURE
  m.first = m.second = -1;
  m.family = family;
  return m;
}

/// Bits 1 << TEXTURED_* of the fields for which the material has a texture.
inline unsigned textured_fields(const Material& m) {
  unsigned fields = 0;
#define NOTE_TEXTURE(_, type, name) fields |= m.name##_texture >= 0 ? 1u << TEXTURED_##name : 0u;
  TEXTURED_FIELDS(NOTE_TEXTURE, _)
#undef NOTE_TEXTURE
  return fields;
}

}  // namespace penumbra
