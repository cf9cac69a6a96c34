// What a stage of its own finds out about lights before an integrator's step: many times the arithmetic of
// the step itself, which scenes that do not ask for it shall not carry.
#ifndef PENUMBRA_LIGHT_AIM_H
#define PENUMBRA_LIGHT_AIM_H
#include "kernels/intersect/surface.h"

PENUMBRA_NAMESPACE_BEGIN

/// Number of the polygon light that the surface is a part of, or -1.
FN int own_polygon(const PRIVATE Scene* scene, Surface s) {
  const int polygon = scene->lights[s.light >= 0 ? s.light : 0].polygon;
  return s.light >= 0 ? polygon : -1;
}

/// Index of the light that a ray finds which ends on this surface, or leaves the scene; negative: none, or
/// the back of it.
FN int light_found(const PRIVATE Scene* scene, Surface s) {
  const int two_sided = scene->lights[s.light >= 0 ? s.light : 0].two_sided;
  int index = (s.front | (two_sided != 0)) ? s.light : -1;
#if HAS(ENVIRONMENT)
  index = s.valid ? index : scene->header.environment;
#endif
  return index;
}

/// Whether the surface is a part of that light and does not see it: of a flat one, or of a sphere unless it
/// is the shining inside of one. Formulas cannot tell: rounding puts the surface to either side of the
/// light's plane or sphere, which covers half the directions or nothing.
FN bool is_own_light(const PRIVATE Scene* scene, Surface s, int light) {
  bool own = light == s.light;
#if HAS(QUADRICS)
  const int kind = scene->lights[light].kind;
  const float orientation = scene->lights[light].p2.y;
  own = own & !((kind == LIGHT_SPHERE) & (orientation < 0.0f) & s.front);
#endif
#if HAS(POLYGONS)
  const int mine = own_polygon(scene, s), polygon = scene->lights[light].polygon;
  own = own | ((mine >= 0) & (polygon == mine));
#endif
  return own;
}

/// Densities of projected solid angle leave out the choice of the light.
typedef struct {
  float found_pdf;  ///< density with which the last ray's direction would have been chosen, or negative
  float light;      ///< index of the light that the step is to sample; negative: the step chooses by power
  float pmf;        ///< probability of having chosen it
  vec3 wi;          ///< towards it
  float scale;  ///< the density of wi is its cosine times this; negative: the step chooses where on the light
} Aim;

enum { AIM_FOUND_PDF, AIM_LIGHT, AIM_PMF, AIM_X, AIM_Y, AIM_Z, AIM_SCALE, AIM_COUNT };
#define HAS_AIMS (HAS(PROJECTED) || HAS(POLYGONS))
// Floats of a PRIVATE array of Aims, value V of lane j at V * LANES + j.
#define AIM_FLOATS (HAS_AIMS ? AIM_COUNT * LANES : 1)

FN Aim no_aim(void) {
  Aim aim;
  aim.found_pdf = aim.light = aim.scale = -1.0f;
  aim.pmf = 0.0f;
  aim.wi = make_vec3(0.0f, 0.0f, 1.0f);
  return aim;
}

FN void store_aim(PRIVATE float* aims, int j, Aim aim) {
#if HAS_AIMS
  aims[AIM_FOUND_PDF * LANES + j] = aim.found_pdf;
  aims[AIM_LIGHT * LANES + j] = aim.light;
  aims[AIM_PMF * LANES + j] = aim.pmf;
  aims[AIM_X * LANES + j] = aim.wi.x;
  aims[AIM_Y * LANES + j] = aim.wi.y;
  aims[AIM_Z * LANES + j] = aim.wi.z;
  aims[AIM_SCALE * LANES + j] = aim.scale;
#endif
}

/// Lane j's; none where the kernel is compiled without.
FN Aim load_aim(const PRIVATE float* aims, int j) {
  Aim aim = no_aim();
#if HAS_AIMS
  aim.found_pdf = aims[AIM_FOUND_PDF * LANES + j];
  aim.light = aims[AIM_LIGHT * LANES + j];
  aim.pmf = aims[AIM_PMF * LANES + j];
  aim.wi = make_vec3(aims[AIM_X * LANES + j], aims[AIM_Y * LANES + j], aims[AIM_Z * LANES + j]);
  aim.scale = aims[AIM_SCALE * LANES + j];
#endif
  return aim;
}

PENUMBRA_NAMESPACE_END
#endif
