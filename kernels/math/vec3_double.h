// A vector of three doubles, for closed forms; never stored.
#ifndef PENUMBRA_VEC3_DOUBLE_H
#define PENUMBRA_VEC3_DOUBLE_H
#ifdef PENUMBRA_GLSL
  #include "kernels/math/math_glsl.h"
#else
  #include "kernels/math/math_double.h"
#endif
#include "kernels/math/vec3.h"

PENUMBRA_NAMESPACE_BEGIN

#ifndef PENUMBRA_GLSL  // in GLSL it is a vec3
typedef struct {
  double x, y, z;
} vec3d;
#endif

FN vec3d make_vec3d(double x, double y, double z) {
  vec3d r;
  r.x = x;
  r.y = y;
  r.z = z;
  return r;
}
FN vec3d widen3(vec3 v) { return make_vec3d(v.x, v.y, v.z); }
FN vec3d add_d(vec3d a, vec3d b) { return make_vec3d(a.x + b.x, a.y + b.y, a.z + b.z); }
FN vec3d sub_d(vec3d a, vec3d b) { return make_vec3d(a.x - b.x, a.y - b.y, a.z - b.z); }
FN vec3d scale_d(vec3d a, double s) { return make_vec3d(a.x * s, a.y * s, a.z * s); }
/// a + s b
FN vec3d add_scaled_d(vec3d a, double s, vec3d b) { return add_d(a, scale_d(b, s)); }
FN double dot3_d(vec3d a, vec3d b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
FN vec3d cross3_d(vec3d a, vec3d b) {
  return make_vec3d(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
FN vec3d select3_d(bool c, vec3d a, vec3d b) {
  return make_vec3d(c ? a.x : b.x, c ? a.y : b.y, c ? a.z : b.z);
}

PENUMBRA_NAMESPACE_END
#endif
