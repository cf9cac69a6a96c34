// Integrators whose samples all start at the surface that the camera ray hit: step k takes the k-th of them.
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

/// Before a step's samples ask for rays: none, and a path goes on if a step is left and there is a surface.
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
