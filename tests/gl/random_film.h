// Films of random numbers for tests.
#pragma once

#include <random>
#include <vector>

#include "gl/gl_objects.h"
#include "scheduler/plan/tile_snapshot.h"

namespace penumbra {

inline std::vector<float> random_floats(std::size_t count, float low, float high, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> distribution(low, high);
  std::vector<float> values(count);
  for (float& value : values) value = distribution(generator);
  return values;
}

inline TileSnapshot random_tile(int x, int y, int width, int height, unsigned seed,
                                std::uint32_t samples = 16) {
  TileSnapshot tile;
  tile.x = x;
  tile.y = y;
  tile.width = width;
  tile.height = height;
  tile.samples = samples;
  tile.radiance = random_floats(3 * tile.pixels(), 0, 2, seed);
  tile.difference = random_floats(3 * tile.pixels(), -1, 1, seed + 1);
  tile.standard_error = random_floats(tile.pixels(), 1e-4f, 1, seed + 2);
  return tile;
}

/// RGBA32F; alpha 1.
inline Texture texture_of(const std::vector<float>& rgb, int width, int height) {
  std::vector<float> rgba;
  for (std::size_t i = 0; i < rgb.size(); i += 3)
    rgba.insert(rgba.end(), {rgb[i], rgb[i + 1], rgb[i + 2], 1});
  Texture texture = make_texture(GL_RGBA32F, width, height, GL_RGBA, GL_FLOAT);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_FLOAT, rgba.data());
  return texture;
}

}  // namespace penumbra
