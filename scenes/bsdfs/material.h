// Helpers that convert BSDFs to materials of the kernels.
#pragma once

#include "kernels/scene_types.h"
#include "scenes/textured.h"

namespace penumbra {

/// A material of that family without children, with all fields 0 and no textures.
inline Material material_of_family(int family) {
  Material m{};
#define NO_TEXTURE(_, type, name) m.name##_texture = kNoTexture;
  MATERIAL_TEXTURES(NO_TEXTURE, _)
#undef NO_TEXTURE
  m.first = m.second = -1;
  m.family = family;
  return m;
}

/// Whether the refractive index differs between colour channels.
inline bool disperses(const Material& m) { return m.channel_ior.x != 0.0f; }

/// The set of fields that have a texture, as bits 1 << TEXTURED_*.
inline unsigned textured_fields(const Material& m) {
  unsigned fields = 0;
#define NOTE_TEXTURE(_, type, name) fields |= m.name##_texture >= 0 ? 1u << TEXTURED_##name : 0u;
  TEXTURED_FIELDS(NOTE_TEXTURE, _)
#undef NOTE_TEXTURE
  return fields;
}

}  // namespace penumbra
