// Parameters that may have a texture.
#pragma once

#include <glm/glm.hpp>

#include "kernels/scene_types.h"
#include "scenes/device/to_vec3.h"

namespace penumbra {

constexpr int kNoTexture = -1;

/// A colour in linear Rec. 709: a constant, or a texture given by its index in SceneDescription::textures.
struct TexturedColour {
  glm::vec3 value{0.0f};
  int texture = kNoTexture;
  TexturedColour() = default;
  TexturedColour(const glm::vec3& plain) : value(plain) {}
  friend bool operator==(const TexturedColour&, const TexturedColour&) = default;
  /// Whether the colour may be anything but black.
  [[nodiscard]] bool is_lit() const { return texture != kNoTexture || value != glm::vec3(0.0f); }
};

/// A number: a constant, or the luminance of a texture.
struct TexturedNumber {
  float value = 0.0f;
  int texture = kNoTexture;
  TexturedNumber() = default;
  TexturedNumber(float plain) : value(plain) {}
  friend bool operator==(const TexturedNumber&, const TexturedNumber&) = default;
};

/// Sets a field of a material and the index of its texture.
inline void set_field(vec3& field, int& texture, const TexturedColour& colour) {
  field = to_vec3(colour.value);
  texture = colour.texture;
}
inline void set_field(float& field, int& texture, const TexturedNumber& number) {
  field = number.value;
  texture = number.texture;
}
#define PENUMBRA_SET_FIELD(material, name, value) set_field((material).name, (material).name##_texture, value)

}  // namespace penumbra
