// Texels in their files' formats, packed into words, lowest bytes first: row by row, the channels of a texel
// side by side, without padding. The functions return the three channels of a texel, all equal if there is
// one.
#ifndef PENUMBRA_TEXEL_H
#define PENUMBRA_TEXEL_H
#include "kernels/math/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// Where a bitmap is, and how its texels are decoded.
typedef struct {
  uint words;    ///< start of the bitmap
  uint table;    ///< start of its table of decoded values
  bool decodes;  ///< it has such a table
  bool grey;     ///< one channel
} TexelFormat;

/// 32 bits, starting at that byte of the bitmap.
FN uint texel_bits(const PRIVATE Scene* scene, TexelFormat format, uint byte) {
  const uint word = format.words + (byte >> 2), shift = 8u * (byte & 3u);
  // Two shifts, since a shift by 32 bits does nothing.
  return (scene->texels[word] >> shift) | ((scene->texels[word + 1u] << 1) << (31u - shift));
}

FN float decoded_value(const PRIVATE Scene* scene, TexelFormat format, uint value) {
  return BITS_FLOAT(scene->texels[format.table + value]);
}

/// 8-bit texels have a table of 256 values, sRGB or not.
FN vec3 byte_texel(const PRIVATE Scene* scene, TexelFormat format, uint index) {
  const uint found = texel_bits(scene, format, format.grey ? index : 3u * index);
  const uint bits = format.decodes ? found : 0u;
  const uint r = bits & 255u, g = format.grey ? r : (bits >> 8) & 255u,
             b = format.grey ? r : (bits >> 16) & 255u;
  return make_vec3(decoded_value(scene, format, r), decoded_value(scene, format, g),
                   decoded_value(scene, format, b));
}

/// Three 16-bit values.
typedef struct {
  uint r, g, b;
} TexelShorts;

FN TexelShorts texel_shorts(const PRIVATE Scene* scene, TexelFormat format, uint index) {
  const uint at = format.grey ? index : 3u * index;
  const uint word = format.words + (at >> 1);
  const uint low = scene->texels[word], high = scene->texels[word + 1u];
  const bool even = (at & 1u) == 0u;
  TexelShorts s;
  s.r = even ? low & 0xffffu : low >> 16;
  const uint g = even ? low >> 16 : high & 0xffffu, b = even ? high & 0xffffu : high >> 16;
  s.g = format.grey ? s.r : g;
  s.b = format.grey ? s.r : b;
  return s;
}

/// 16-bit texels have a table of 65536 values, or none: then they are linear.
FN float short_value(const PRIVATE Scene* scene, TexelFormat format, uint value) {
  const float by_table = decoded_value(scene, format, format.decodes ? value : 0u);
  return format.decodes ? by_table : (float)(int)value / 65535.0f;
}

FN vec3 short_texel(const PRIVATE Scene* scene, TexelFormat format, uint index) {
  const TexelShorts s = texel_shorts(scene, format, index);
  return make_vec3(short_value(scene, format, s.r), short_value(scene, format, s.g),
                   short_value(scene, format, s.b));
}

/// A finite half-precision number, exactly: independent of a device's treatment of subnormal numbers.
FN float half_value(uint bits) {
  const uint size = bits & 0x7fffu;
  const float normal = BITS_FLOAT((size << 13) + (112u << 23));
  const float subnormal = (float)(int)size * 5.9604645e-8f;  // 2^-24
  const float value = size < 0x400u ? subnormal : normal;
  return (bits & 0x8000u) != 0u ? -value : value;
}

FN vec3 half_texel(const PRIVATE Scene* scene, TexelFormat format, uint index) {
  const TexelShorts s = texel_shorts(scene, format, index);
  return make_vec3(half_value(s.r), half_value(s.g), half_value(s.b));
}

FN vec3 float_texel(const PRIVATE Scene* scene, TexelFormat format, uint index) {
  const uint at = format.words + (format.grey ? index : 3u * index);
  const uint next = format.grey ? 0u : 1u;
  return make_vec3(BITS_FLOAT(scene->texels[at]), BITS_FLOAT(scene->texels[at + next]),
                   BITS_FLOAT(scene->texels[at + 2u * next]));
}

PENUMBRA_NAMESPACE_END
#endif
