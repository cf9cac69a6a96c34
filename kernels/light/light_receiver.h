// The receiver of light: a point on a surface, or in a medium.
#ifndef PENUMBRA_LIGHT_RECEIVER_H
#define PENUMBRA_LIGHT_RECEIVER_H
#include "kernels/intersect/surface.h"
#include "kernels/light/light_kinds.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  vec3 p;
  float error;      ///< see Surface; 0 without a normal, so that ray origins are not offset
  vec3 geometric;   ///< see Surface; 0 without a normal
  vec3 shading;     ///< see Surface; 0 without a normal
  bool has_normal;  ///< false: a point in a medium, which light reaches from all directions
  bool front;       ///< wo is on the surface's front side
  int light;        ///< the light that the surface is part of, or -1
} LightReceiver;

/// The receiver at this surface. A point in a medium has no normal: see surface_in_medium.
FN LightReceiver receiver_of(Surface s) {
  LightReceiver r;
  r.p = s.p;
  r.error = s.error;
  r.geometric = s.geometric;
  r.shading = s.shading;
  r.has_normal = dot3(s.geometric, s.geometric) > 0.0f;
  r.front = s.front;
  r.light = s.light;
  return r;
}

/// The polygon light that light `light` is part of, or -1; `light` may be -1.
FN int own_polygon(const PRIVATE Scene* scene, int light) {
  const int polygon = scene->lights[light >= 0 ? light : 0].polygon;
  return light >= 0 ? polygon : -1;
}

/// Whether the receiver is part of that light and gets no light from it: it is on a flat light, or on a
/// sphere or cylinder, except on an inside that emits. Formulas cannot decide this: rounding puts the surface
/// on either side of the light's plane or sphere, which then covers half of the directions or none.
FN bool is_own_light(const PRIVATE Scene* scene, LightReceiver r, int light) {
  bool own = light == r.light;
  if (NEEDS_LIGHT(scene, SPHERE) || NEEDS_LIGHT(scene, CYLINDER)) {
    const int kind = scene->lights[light].kind;
    const float orientation = scene->lights[light].p2.y;
    const bool hollow = (kind == LIGHT_SPHERE) | (kind == LIGHT_CYLINDER);
    own = own & !(hollow & (orientation < 0.0f) & r.front);
  }
  if (HAS(POLYGONS)) {
    const int mine = own_polygon(scene, r.light), polygon = scene->lights[light].polygon;
    own = own | ((mine >= 0) & (polygon == mine));
  }
  return own;
}

PENUMBRA_NAMESPACE_END
#endif
