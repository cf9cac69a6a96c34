// Value noise in octaves; the formula is in kernels/texture/noise_texture.h.
#pragma once

#include <cstdint>

#include "scenes/plugin_values.h"
#include "scenes/textured.h"

namespace penumbra {

struct NoiseTexture {
  static constexpr const char* kPlugin = "noise";
  static constexpr const char* kText = "value noise in octaves, between two colours";
  TexturedColour color0{glm::vec3(0.0f)};
  TexturedColour color1{glm::vec3(1.0f)};
  std::int64_t seed = 0;
  std::int64_t octaves = 4;
  float persistence = 0.5f;
  float lacunarity = 2.0f;

  template <typename Row>
  static void parameters(const Row& row) {
    row("color0", &NoiseTexture::color0, ColourWithin{0.0f, kAnyNumber}, "colour where the noise is 0");
    row("color1", &NoiseTexture::color1, ColourWithin{0.0f, kAnyNumber}, "colour where the noise is 1");
    row("seed", &NoiseTexture::seed, WholeNumber{0, kMaxInt}, "of the random numbers");
    row("octaves", &NoiseTexture::octaves, WholeNumber{1, MAX_NOISE_OCTAVES},
        "how many are summed; one has a number at each whole u and v");
    row("persistence", &NoiseTexture::persistence, NumberWithin{LowEnd::kClosed, 0.0f, 16.0f},
        "height of an octave over that of the one before");
    row("lacunarity", &NoiseTexture::lacunarity, NumberWithin{LowEnd::kOpen, 0.0f, 16.0f},
        "frequency of an octave over that of the one before");
  }
  void complete(Findings& findings) {
    if (color0.texture != kNoTexture || color1.texture != kNoTexture)
      findings.push_back({"", "the colours of noise must be colours, not textures"});
    color0.texture = color1.texture = kNoTexture;
  }
};

inline TextureNode texture_of(const NoiseTexture& noise) {
  TextureNode t{};
  t.kind = TEXTURE_NOISE;
  t.texture0 = t.texture1 = kNoTexture;
  t.colour0 = to_vec3(noise.color0.value);
  t.colour1 = to_vec3(noise.color1.value);
  t.seed = uint(noise.seed);
  t.octaves = int(noise.octaves);
  t.persistence = noise.persistence;
  t.lacunarity = noise.lacunarity;
  return t;
}

}  // namespace penumbra
