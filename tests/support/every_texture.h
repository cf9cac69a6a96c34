// A scene with all kinds of textures.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "scenes/scene_description.h"

namespace penumbra {

/// Gives each material of the scene textures, of every kind and with every filter, wrap mode and encoding
/// among them, on its colours and on a number.
inline void add_every_texture(SceneDescription& scene) {
  std::uint32_t state = 1;
  for (const TexelType type : {TexelType::kByte, TexelType::kShort, TexelType::kHalf, TexelType::kFloat}) {
    Bitmap bitmap{"", 13, 9, type == TexelType::kShort ? 1 : 3, type, {}};
    const std::size_t bytes = 13 * 9 * std::size_t(bitmap.channels) * size_of(type);
    for (std::size_t i = 0; i < (bytes + 3) / 4; ++i) {
      const std::uint32_t random = state = state * 1664525u + 1013904223u;
      // Halves and floats in [0.5, 1).
      bitmap.words.push_back(type == TexelType::kFloat  ? 0x3f000000u | random >> 9
                             : type == TexelType::kHalf ? 0x38003800u | (random >> 6 & 0x03ff03ffu)
                                                        : random);
    }
    scene.bitmaps.push_back(std::make_shared<const Bitmap>(std::move(bitmap)));
  }
  const glm::dmat3 turned(glm::dvec3(2.1, 0.7, 0), glm::dvec3(-0.9, 1.7, 0), glm::dvec3(0.3, -0.4, 1));
  for (int i = 0; i < 10; ++i) {
    BitmapTexture bitmap;
    bitmap.bitmap = i % 4;
    bitmap.wrap_u = i % 5;
    bitmap.wrap_v = (i + 2) % 5;
    bitmap.gamma = i < 4 ? kSrgb : i < 8 ? 1.0f : 1.7f;
    bitmap.filter = i % 3 == 1 ? BitmapFilter::kNearest : BitmapFilter::kBilinear;
    scene.textures.push_back({"", bitmap, turned});
  }
  CheckerboardTexture board;
  board.color0 = glm::vec3(0.9f, 0.5f, 0.1f);
  board.color0.texture = 0;
  board.color1.texture = 3;
  scene.textures.push_back({"", board, turned});
  NoiseTexture noise;
  noise.color1 = glm::vec3(0.7f, 0.8f, 0.9f);
  scene.textures.push_back({"", noise, glm::dmat3(9.0)});
  scene.textures.push_back({"", MeshAttributeTexture{}});
  scene.textures.push_back({"", ScaleTexture{glm::vec3(0.9f, 0.7f, 0.8f), 10}});
  const int exponents = int(scene.textures.size());
  scene.textures.push_back({"", ScaleTexture{glm::vec3(40.0f), 1}});
  // One of them or another, by checkerboards of checkerboards.
  std::vector<int> all;
  for (int i = 0; i < exponents; ++i) all.push_back(i);
  for (double size = 1.3; all.size() > 1; size *= 2.1) {
    std::vector<int> pairs;
    for (std::size_t i = 0; i < all.size(); i += 2) {
      CheckerboardTexture pair;
      pair.color0 = pair.color1 = glm::vec3(1.0f);
      pair.color0.texture = all[i];
      pair.color1.texture = all[std::min(i + 1, all.size() - 1)];
      pairs.push_back(int(scene.textures.size()));
      scene.textures.push_back({"", pair, glm::dmat3(size)});
    }
    all = pairs;
  }
  const auto add_scaled = [&](float scale, int texture) {
    scene.textures.push_back({"", ScaleTexture{glm::vec3(scale), texture}});
    return int(scene.textures.size()) - 1;
  };
  for (Shape& shape : scene.shapes)
    if (auto* mesh = std::get_if<Mesh>(&shape.geometry))
      for (std::size_t i = 0; i < mesh->positions.size(); ++i)
        mesh->colours.emplace_back(i % 2, 0.5f, 1.0f - float(i % 2));
  for (std::size_t i = 0; i < scene.bsdfs.size(); ++i) {
    PhongBsdf phong{glm::vec3(0.5f), glm::vec3(0.2f), 30.0f};
    phong.diffuse.texture = add_scaled(0.6f, all[0]);
    phong.specular.texture = add_scaled(0.3f, int(i) % exponents);
    phong.exponent.texture = exponents;
    scene.bsdfs[i].model = phong;
  }
}

}  // namespace penumbra
