// Orthonormal frames, and sampling of directions in them.
#ifndef PENUMBRA_FRAME_H
#define PENUMBRA_FRAME_H
#include "kernels/math/math.h"
#include "kernels/math/vec3.h"

PENUMBRA_NAMESPACE_BEGIN

/// `x s + y t + z n` for the frame (s, t, n) about the unit vector n (Duff et al. 2017).
FN vec3 from_frame(vec3 n, float x, float y, float z) {
  float sign = n.z >= 0.0f ? 1.0f : -1.0f;
  float a = -1.0f / (sign + n.z);
  float b = n.x * n.y * a;
  vec3 s = make_vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
  vec3 t = make_vec3(b, sign + n.y * n.y * a, -n.y);
  return add(add(scale(s, x), scale(t, y)), scale(n, z));
}

/// (x, y, z) with v = from_frame(n, x, y, z).
FN vec3 to_frame(vec3 n, vec3 v) {
  float sign = n.z >= 0.0f ? 1.0f : -1.0f;
  float a = -1.0f / (sign + n.z);
  float b = n.x * n.y * a;
  vec3 s = make_vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
  vec3 t = make_vec3(b, sign + n.y * n.y * a, -n.y);
  return make_vec3(dot3(v, s), dot3(v, t), dot3(v, n));
}

/// The first axis s of a frame (s, cross3(n, s), n) about the unit vector n: the direction of v's part
/// perpendicular to n. If that is 0, the first axis of from_frame.
FN vec3 tangent_axis(vec3 n, vec3 v) {
  const vec3 w = scale(v, 1.0f / max_f(max_component(abs3(v)), 1e-30f));
  vec3 part = add_scaled(w, -dot3(n, w), n);
  part = add_scaled(part, -dot3(n, part),
                    n);  // removes rounding errors of the first step, where w is nearly along n
  const float length2 = dot3(part, part);
  const bool some = length2 > 1e-8f;
  return select3(some, scale(part, 1.0f / SQRT(some ? length2 : 1.0f)), from_frame(n, 1.0f, 0.0f, 0.0f));
}

/// Samples the pdf cos / pi about the z axis.
FN vec3 cosine_hemisphere(float u, float v) {
  float s, c;
  sincos_2pi(v, &s, &c);
  const float r = SQRT(u);
  return make_vec3(r * c, r * s, SQRT(1.0f - u));
}

/// Samples the pdf cos / pi about n.
FN vec3 sample_cosine_hemisphere(vec3 n, float u, float v) {
  const vec3 w = cosine_hemisphere(u, v);
  return from_frame(n, w.x, w.y, w.z);
}

/// Samples the pdf 1 / (2 pi) about n.
FN vec3 sample_uniform_hemisphere(vec3 n, float u, float v) {
  float s, c;
  sincos_2pi(v, &s, &c);
  float r = safe_sqrt(u * (2.0f - u));
  return from_frame(n, r * c, r * s, 1.0f - u);
}

/// Samples the pdf 1 / (4 pi).
FN vec3 sample_uniform_sphere(float u, float v) {
  float s, c;
  sincos_2pi(v, &s, &c);
  float z = 1.0f - 2.0f * u;
  float r = 2.0f * safe_sqrt(u * (1.0f - u));
  return make_vec3(r * c, r * s, z);
}

PENUMBRA_NAMESPACE_END
#endif
