// Surfaces of LANES paths: found once for all stages of a step.
#ifndef PENUMBRA_SURFACE_LANES_H
#define PENUMBRA_SURFACE_LANES_H
#include "kernels/block/path_state.h"
#include "kernels/intersect/surface.h"

PENUMBRA_NAMESPACE_BEGIN

/// One a lane; coordinate c of lane j at c * LANES + j.
typedef struct {
  int valid[LANES], front[LANES], material[LANES], light[LANES];
  float p[3 * LANES], error[LANES], geometric[3 * LANES], shading[3 * LANES], wo[3 * LANES], distance[LANES];
} Surfaces;

FN void store_surface(PRIVATE Surfaces* surfaces, int j, Surface s) {
  surfaces->valid[j] = s.valid ? 1 : 0;
  surfaces->front[j] = s.front ? 1 : 0;
  surfaces->material[j] = s.material;
  surfaces->light[j] = s.light;
  STORE3(surfaces->p, LANES, 0, j, s.p);
  surfaces->error[j] = s.error;
  STORE3(surfaces->geometric, LANES, 0, j, s.geometric);
  STORE3(surfaces->shading, LANES, 0, j, s.shading);
  STORE3(surfaces->wo, LANES, 0, j, s.wo);
  surfaces->distance[j] = s.distance;
}

FN Surface load_surface(const PRIVATE Surfaces* surfaces, int j) {
  Surface s;
  s.valid = surfaces->valid[j] != 0;
  s.front = surfaces->front[j] != 0;
  s.material = surfaces->material[j];
  s.light = surfaces->light[j];
  s.p = LOAD3(surfaces->p, LANES, 0, j);
  s.error = surfaces->error[j];
  s.geometric = LOAD3(surfaces->geometric, LANES, 0, j);
  s.shading = LOAD3(surfaces->shading, LANES, 0, j);
  s.wo = LOAD3(surfaces->wo, LANES, 0, j);
  s.distance = surfaces->distance[j];
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
