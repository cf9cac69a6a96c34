// Bitmap textures, as in Mitsuba 3: the first row is at v = 0, the centre of texel (i, j) is at ((i + 1/2) /
// width, (j + 1/2) / height), and values are bilinear between centres. Outside of the unit square the bitmap
// repeats, is mirrored, is clamped, or is 0 or 1 (as in Mitsuba 0.6).
#ifndef PENUMBRA_BITMAP_TEXTURE_H
#define PENUMBRA_BITMAP_TEXTURE_H
#include "kernels/math/math.h"
#include "kernels/scene.h"
#include "kernels/texture/texture_step.h"

PENUMBRA_NAMESPACE_BEGIN

// Texels in their files' formats, packed into words, lowest bytes first: row by row, the channels of a texel
// side by side, without padding. The functions return the three channels of a texel, all equal if there is
// one.

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

/// Two neighbouring texels along an axis, and the interpolation weight of the second. A texel outside of the
/// bitmap has the value of its border if that is >= 0.
typedef struct {
  int low, high;
  float share;
  float low_border, high_border;
} TexelPair;

/// A coordinate within one repetition; NaN becomes 0.
FN float wrapped_coordinate(int wrap, float t) {
  const float repeated = t - floor_f(t);
  const float of_two = t - 2.0f * floor_f(0.5f * t);
  const float mirrored = of_two > 1.0f ? 2.0f - of_two : of_two;
  const float folded = wrap == WRAP_REPEAT ? repeated : (wrap == WRAP_MIRROR ? mirrored : t);
  const bool bordered = wrap >= WRAP_ZERO;
  return clamp_f(folded, bordered ? -1.0f : 0.0f, bordered ? 2.0f : 1.0f);
}

/// Index of a texel that is at most one beyond the edges, or anywhere if there is a border.
FN int wrapped_texel(int wrap, int size, int i) {
  const int repeated = i < 0 ? i + size : (i >= size ? i - size : i);
  const int at = wrap == WRAP_REPEAT ? repeated : i;
  return at < 0 ? 0 : min_i(at, size - 1);
}

FN float border_of(int wrap, int size, int i) {
  const bool outside = (wrap >= WRAP_ZERO) & ((i < 0) | (i >= size));
  return outside ? (wrap == WRAP_ONE ? 1.0f : 0.0f) : -1.0f;
}

FN TexelPair texel_pair(int wrap, bool nearest, int size, float t) {
  const float at = wrapped_coordinate(wrap, t) * (float)size - (nearest ? 0.0f : 0.5f);
  const float whole = floor_f(at);
  const int i = (int)whole;
  TexelPair pair;
  pair.low = wrapped_texel(wrap, size, i);
  pair.high = wrapped_texel(wrap, size, i + 1);
  pair.low_border = border_of(wrap, size, i);
  pair.high_border = border_of(wrap, size, i + 1);
  pair.share = nearest ? 0.0f : at - whole;
  return pair;
}

FN vec3 blend3(vec3 a, vec3 b, float share) { return add_scaled(a, share, sub(b, a)); }

FN vec3 bordered_texel(float border_u, float border_v, vec3 texel) {
  const float border = border_u >= 0.0f ? border_u : border_v;
  return select3(border >= 0.0f, make_vec3(border, border, border), texel);
}

// Lanes whose texture is of another kind read the first words.
#define BITMAP_TEXTURE(name, kind_number)                                                             \
  FN TextureStep name##_bitmap_texture(const PRIVATE Scene* scene, GLOBAL const TextureNode* texture, \
                                       TexturePlace at) {                                             \
    const bool here = texture->kind == (kind_number);                                                 \
    const int width = here ? texture->width : 1, height = here ? texture->height : 1;                 \
    TexelFormat format;                                                                               \
    format.words = here ? (uint)texture->texels : 0u;                                                 \
    format.decodes = here & (texture->decoding >= 0);                                                 \
    format.table = format.decodes ? (uint)texture->decoding : 0u;                                     \
    format.grey = texture->channels == 1;                                                             \
    const bool nearest = texture->nearest != 0;                                                       \
    const TexelPair x = texel_pair(texture->wrap_u, nearest, width, at.u);                            \
    const TexelPair y = texel_pair(texture->wrap_v, nearest, height, at.v);                           \
    const uint low = (uint)y.low * (uint)width, high = (uint)y.high * (uint)width;                    \
    const vec3 t00 = name##_texel(scene, format, low + (uint)x.low);                                  \
    const vec3 t10 = name##_texel(scene, format, low + (uint)x.high);                                 \
    const vec3 t01 = name##_texel(scene, format, high + (uint)x.low);                                 \
    const vec3 t11 = name##_texel(scene, format, high + (uint)x.high);                                \
    const vec3 first = blend3(bordered_texel(x.low_border, y.low_border, t00),                        \
                              bordered_texel(x.high_border, y.low_border, t10), x.share);             \
    const vec3 second = blend3(bordered_texel(x.low_border, y.high_border, t01),                      \
                               bordered_texel(x.high_border, y.high_border, t11), x.share);           \
    TextureStep step;                                                                                 \
    step.factor = blend3(first, second, y.share);                                                     \
    step.next = texture->texture0;                                                                    \
    return step;                                                                                      \
  }
BITMAP_TEXTURE(byte, TEXTURE_BYTE_BITMAP)
BITMAP_TEXTURE(short, TEXTURE_SHORT_BITMAP)
BITMAP_TEXTURE(half, TEXTURE_HALF_BITMAP)
BITMAP_TEXTURE(float, TEXTURE_FLOAT_BITMAP)
#undef BITMAP_TEXTURE

PENUMBRA_NAMESPACE_END
#endif
