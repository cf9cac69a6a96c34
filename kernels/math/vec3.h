// A packed vector of three floats: 12 bytes in every language (OpenCL's float3 takes 16).
#ifndef PENUMBRA_VEC3_H
#define PENUMBRA_VEC3_H
#include "kernels/math/math.h"

PENUMBRA_NAMESPACE_BEGIN

#ifndef PENUMBRA_GLSL  // GLSL has its own
typedef struct {
  float x, y, z;
} vec3;
#endif

FN vec3 make_vec3(float x, float y, float z) {
  vec3 r;
  r.x = x;
  r.y = y;
  r.z = z;
  return r;
}
#ifndef PENUMBRA_GLSL
/// Reads component by component: a struct copy is a load that lane loops cannot vectorise.
FN vec3 load3(GLOBAL const vec3* v) { return make_vec3(v->x, v->y, v->z); }
/// Luminance of a colour (Rec. 709); exact for greys.
FN float luminance(vec3 colour) {
  const bool grey = (colour.x == colour.y) & (colour.y == colour.z);
  const float sum = (0.212671f * colour.x + 0.715160f * colour.y) + 0.072169f * colour.z;
  return grey ? colour.x : sum;
}
#endif
FN vec3 add(vec3 a, vec3 b) { return make_vec3(a.x + b.x, a.y + b.y, a.z + b.z); }
FN vec3 sub(vec3 a, vec3 b) { return make_vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
FN vec3 mul(vec3 a, vec3 b) { return make_vec3(a.x * b.x, a.y * b.y, a.z * b.z); }
FN vec3 scale(vec3 a, float s) { return make_vec3(a.x * s, a.y * s, a.z * s); }
FN vec3 negate(vec3 a) { return make_vec3(-a.x, -a.y, -a.z); }
/// a + s b
FN vec3 add_scaled(vec3 a, float s, vec3 b) { return add(a, scale(b, s)); }
/// Interpolates from a (t = 0) to b (t = 1), both exactly.
FN vec3 mix3(vec3 a, vec3 b, float t) { return add(scale(a, 1.0f - t), scale(b, t)); }
FN vec3 min3(vec3 a, vec3 b) { return make_vec3(min_f(a.x, b.x), min_f(a.y, b.y), min_f(a.z, b.z)); }
FN vec3 max3(vec3 a, vec3 b) { return make_vec3(max_f(a.x, b.x), max_f(a.y, b.y), max_f(a.z, b.z)); }
FN vec3 abs3(vec3 a) { return make_vec3(FABS(a.x), FABS(a.y), FABS(a.z)); }
FN float dot3(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
/// Exactly antisymmetric in its arguments, since nothing here is contracted to fma.
FN vec3 cross3(vec3 a, vec3 b) {
  return make_vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
FN float length3(vec3 a) { return SQRT(dot3(a, a)); }
FN vec3 normalize3(vec3 a) { return scale(a, 1.0f / SQRT(dot3(a, a))); }
FN vec3 select3(bool c, vec3 a, vec3 b) { return make_vec3(c ? a.x : b.x, c ? a.y : b.y, c ? a.z : b.z); }
/// Component 0, 1 or 2: a colour's channel, or a coordinate.
FN float channel_of(vec3 v, int channel) { return channel == 0 ? v.x : (channel == 1 ? v.y : v.z); }
/// `known` with component `channel` taken from `found`.
FN vec3 with_channel(vec3 known, vec3 found, int channel) {
  return make_vec3(channel == 0 ? found.x : known.x, channel == 1 ? found.y : known.y,
                   channel == 2 ? found.z : known.z);
}
FN bool is_finite3(vec3 v) {
  const uint x = FLOAT_BITS(v.x) & 0x7fffffffu, y = FLOAT_BITS(v.y) & 0x7fffffffu;
  const uint z = FLOAT_BITS(v.z) & 0x7fffffffu;
  return x < 0x7f800000u && y < 0x7f800000u && z < 0x7f800000u;
}

FN float max_component(vec3 a) {
  float m = a.x > a.y ? a.x : a.y;
  return m > a.z ? m : a.z;
}

PENUMBRA_NAMESPACE_END
#endif
