// For integrators whose samples all start at the surface that the camera ray hit: the surface is kept, and
// step k takes the k-th sample.
#ifndef PENUMBRA_KEPT_SURFACES_H
#define PENUMBRA_KEPT_SURFACES_H
#include "kernels/block/block_surface.h"

PENUMBRA_NAMESPACE_BEGIN

STAGE void keep_surfaces(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) keep_surface(paths, i + j, load_surface(surfaces, j));
}
STAGE void load_kept_surfaces(const PRIVATE PathState* paths, int i, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) store_surface_hit(surfaces, j, kept_surface(paths, i + j));
}

/// Before a step requests rays: there are none yet. A path continues if a surface was hit and a step is left.
STAGE void begin_steps(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces,
                       bool is_last) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      set_ray_tmax(paths, i + j, -1.0f);
      set_shadow_tmax(paths, i + j, -1.0f);
      set_alive(paths, i + j, (surfaces->primitive[j] >= 0) & !is_last);
    }
}

PENUMBRA_NAMESPACE_END
#endif
