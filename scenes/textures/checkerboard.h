// A checkerboard that repeats a pattern of four squares.
#pragma once

#include "scenes/plugin_values.h"
#include "scenes/textured.h"

namespace penumbra {

struct CheckerboardTexture {
  static constexpr const char* kPlugin = "checkerboard";
  static constexpr const char* kText = "two colours in squares";
  TexturedColour color0{glm::vec3(0.4f)};
  TexturedColour color1{glm::vec3(0.2f)};

  template <typename Row>
  static void parameters(const Row& row) {
    row("color0", &CheckerboardTexture::color0, ColourWithin{0.0f, kAnyNumber},
        "colour of one half of the squares");
    row("color1", &CheckerboardTexture::color1, ColourWithin{0.0f, kAnyNumber}, "colour of the others");
  }
};

inline TextureNode texture_of(const CheckerboardTexture& checkerboard) {
  TextureNode t{};
  t.kind = TEXTURE_CHECKERBOARD;
  set_field(t.colour0, t.texture0, checkerboard.color0);
  set_field(t.colour1, t.texture1, checkerboard.color1);
  return t;
}

}  // namespace penumbra
