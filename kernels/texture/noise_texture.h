// Value noise: interpolates from colour0 to colour1 by a sum of octaves in [0, 1],
//   n(u, v) = sum_k persistence^k value_k(lacunarity^k u, lacunarity^k v) / sum_k persistence^k.
// value_k is a random number at each integer lattice point, interpolated by (1 - cos pi t) / 2 along either
// axis: what many call Perlin noise, after Hugo Elias.
#ifndef PENUMBRA_NOISE_TEXTURE_H
#define PENUMBRA_NOISE_TEXTURE_H
#include "kernels/sampler/sampler.h"
#include "kernels/texture/texture_step.h"

PENUMBRA_NAMESPACE_BEGIN

FN float lattice_value(uint seed, int x, int y) {
  return unit_float(hash_uint((uint)x + hash_uint((uint)y + seed)));
}

/// From 0 to 1 like t, with slope 0 at both ends.
FN float cosine_step(float t) {
  float s, c;
  sincos_2pi(0.5f * t, &s, &c);
  return 0.5f * (1.0f - c);
}

FN float value_noise(uint seed, float u, float v) {
  // Larger floats are integers.
  const float x = clamp_f(u, -8388608.0f, 8388608.0f), y = clamp_f(v, -8388608.0f, 8388608.0f);
  const float x0 = floor_f(x), y0 = floor_f(y);
  const int i = (int)x0, j = (int)y0;
  const float a = cosine_step(x - x0), b = cosine_step(y - y0);
  const float v00 = lattice_value(seed, i, j), v10 = lattice_value(seed, i + 1, j);
  const float v01 = lattice_value(seed, i, j + 1), v11 = lattice_value(seed, i + 1, j + 1);
  const float low = v00 + a * (v10 - v00), high = v01 + a * (v11 - v01);
  return low + b * (high - low);
}

FN TextureStep noise_texture(const PRIVATE Scene* scene, GLOBAL const TextureNode* texture, TexturePlace at) {
  const float persistence = texture->persistence, lacunarity = texture->lacunarity;
  const int octaves = texture->octaves;
  float sum = 0.0f, weights = 0.0f, weight = 1.0f, scale_by = 1.0f;
  uint seed = texture->seed;
  UNROLL
  for (int k = 0; k < MAX_NOISE_OCTAVES; k++) {
    const float share = k < octaves ? weight : 0.0f;
    seed = hash_uint(seed + (uint)k);
    sum += share * value_noise(seed, scale_by * at.u, scale_by * at.v);
    weights += share;
    weight *= persistence;
    scale_by *= lacunarity;
  }
  const float n = weights > 0.0f ? sum / weights : 0.0f;
  const vec3 colour0 = load3(&texture->colour0), colour1 = load3(&texture->colour1);
  TextureStep step;
  step.factor = add_scaled(colour0, n, sub(colour1, colour0));
  step.next = -1;
  return step;
}

PENUMBRA_NAMESPACE_END
#endif
