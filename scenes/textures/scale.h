// Multiplies a nested texture by a number or a colour (Mitsuba 0.6).
#pragma once

#include "scenes/plugin_values.h"
#include "scenes/textured.h"

namespace penumbra {

struct ScaleTexture {
  static constexpr const char* kPlugin = "scale";
  static constexpr const char* kText = "another texture, multiplied";
  TexturedColour scale{glm::vec3(1.0f)};
  int texture = kNoTexture;  ///< the nested texture, which has no name

  template <typename Row>
  static void parameters(const Row& row) {
    row("scale", &ScaleTexture::scale, ColourWithin{0.0f, kAnyNumber},
        "number or colour by which the texture that it holds is multiplied");
  }
  void complete(Findings& findings) {
    if (scale.texture != kNoTexture)
      findings.push_back({"", "'scale' must be a number or a colour, not another texture"});
    scale.texture = kNoTexture;
  }
};

inline TextureNode texture_of(const ScaleTexture& scale) {
  TextureNode t{};
  t.kind = TEXTURE_SCALE;
  t.colour0 = to_vec3(scale.scale.value);
  t.texture0 = scale.texture;
  t.texture1 = kNoTexture;
  return t;
}

}  // namespace penumbra
