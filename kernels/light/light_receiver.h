// What is lit: a point of a surface, or of a medium.
#ifndef PENUMBRA_LIGHT_RECEIVER_H
#define PENUMBRA_LIGHT_RECEIVER_H
#include "kernels/block/path_state.h"
#include "kernels/intersect/surface.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  vec3 p;
  float error;      ///< see Surface; 0 without a normal, so that no ray's origin is offset
  vec3 geometric;   ///< likewise; 0 without a normal
  vec3 shading;     ///< likewise
  bool has_normal;  ///< false: a point of a medium, which light reaches from all directions
  bool front;       ///< the surface is seen from its front side
  int light;        ///< that the surface is, or -1
} LightReceiver;

FN LightReceiver receiver_of(Surface s) {
  LightReceiver r;
  r.p = s.p;
  r.error = s.error;
  r.geometric = s.geometric;
  r.shading = s.shading;
  r.has_normal = true;
  r.front = s.front;
  r.light = s.light;
  return r;
}

FN LightReceiver receiver_in_medium(vec3 p) {
  LightReceiver r;
  r.p = p;
  r.error = 0.0f;
  r.geometric = r.shading = make_vec3(0.0f, 0.0f, 0.0f);
  r.has_normal = r.front = false;
  r.light = -1;
  return r;
}

/// One a lane; coordinate c of lane j at c * LANES + j.
typedef struct {
  float p[3 * LANES], error[LANES], geometric[3 * LANES], shading[3 * LANES];
  int has_normal[LANES], front[LANES], light[LANES];
} LightReceivers;

FN void store_receiver(PRIVATE LightReceivers* receivers, int j, LightReceiver r) {
  STORE3(receivers->p, LANES, 0, j, r.p);
  receivers->error[j] = r.error;
  STORE3(receivers->geometric, LANES, 0, j, r.geometric);
  STORE3(receivers->shading, LANES, 0, j, r.shading);
  receivers->has_normal[j] = r.has_normal ? 1 : 0;
  receivers->front[j] = r.front ? 1 : 0;
  receivers->light[j] = r.light;
}

FN LightReceiver load_receiver(const PRIVATE LightReceivers* receivers, int j) {
  LightReceiver r;
  r.p = LOAD3(receivers->p, LANES, 0, j);
  r.error = receivers->error[j];
  r.geometric = LOAD3(receivers->geometric, LANES, 0, j);
  r.shading = LOAD3(receivers->shading, LANES, 0, j);
  r.has_normal = receivers->has_normal[j] != 0;
  r.front = receivers->front[j] != 0;
  r.light = receivers->light[j];
  return r;
}

/// Index of the polygon light that the light of that index, or -1, is a part of, or -1.
FN int own_polygon(const PRIVATE Scene* scene, int light) {
  const int polygon = scene->lights[light >= 0 ? light : 0].polygon;
  return light >= 0 ? polygon : -1;
}

/// Whether the receiver is a part of that light and gets nothing from it: a part of a flat light, or of a
/// sphere except its emitting inside. Formulas cannot tell: rounding puts the surface to either side of the
/// light's plane or sphere, which covers half the directions or nothing.
FN bool is_own_light(const PRIVATE Scene* scene, LightReceiver r, int light) {
  bool own = light == r.light;
  if (HAS_LIGHT(SPHERE)) {
    const int kind = scene->lights[light].kind;
    const float orientation = scene->lights[light].p2.y;
    own = own & !((kind == LIGHT_SPHERE) & (orientation < 0.0f) & r.front);
  }
#if HAS(POLYGONS)
  const int mine = own_polygon(scene, r.light), polygon = scene->lights[light].polygon;
  own = own | ((mine >= 0) & (polygon == mine));
#endif
  return own;
}

PENUMBRA_NAMESPACE_END
#endif
