// Shadow rays of neighbours in a block that start on one surface and end on one light, those of direct light:
// what stops one of them mostly stops the next ones. LANES rays at a time meet the triangles that stopped
// others before, and only those that get past go through the hierarchy. Whether a ray gets through depends on
// no order.
#ifndef PENUMBRA_BLOCK_OCCLUDERS_H
#define PENUMBRA_BLOCK_OCCLUDERS_H
#include "kernels/block/path_state.h"
#include "kernels/intersect/bvh.h"

PENUMBRA_NAMESPACE_BEGIN

#if HAS(BVH) && HAS(DIRECT) && LANES > 1
  // That are remembered. One that stops none of LANES rays is forgotten.
  #define MOST_OCCLUDERS 4

typedef struct {
  int count;
  int triangles[MOST_OCCLUDERS];
} Occluders;

/// Whether the scene's shadow rays are such ones, and any hit is all that there is to know of them.
FN bool shares_occluders(const PRIVATE Scene* scene) {
  return scene->header.integrator.kind == INTEGRATOR_DIRECT && !NEEDS(scene, NESTED) &&
         !NEEDS(scene, INSTANCES);
}

STAGE void shear_shadow_rays(const PRIVATE PathState* paths, int i, PRIVATE Shears* RESTRICT shears) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) store_shear(shears, j, make_shear(get_shadow_direction(paths, i + j)));
}

/// Marks the lanes whose shadow rays the triangle stops.
STAGE void stop_by_triangle(const PRIVATE Scene* scene, int index, const PRIVATE PathState* paths, int i,
                            const PRIVATE Shears* RESTRICT shears, PRIVATE int* RESTRICT stopped) {
  const Triangle triangle = scene->triangles[index];
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Shear s = load_shear(shears, j);
      const vec3 o = get_shadow_origin(paths, i + j);
      const TriangleHit h =
          intersect_sheared(shear_point(s, sub(triangle.p0, o)), shear_point(s, sub(triangle.p1, o)),
                            shear_point(s, sub(triangle.p2, o)));
      stopped[j] = (h.inside & (h.t > 0.0f) & (h.t <= get_shadow_tmax(paths, i + j)) &
                    (get_shadow_skip(paths, i + j) != index))
                       ? 1
                       : 0;
    }
}

/// Marks the lanes whose shadow rays one of these stops, and forgets those that stop none.
FN void stop_by_occluders(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                          PRIVATE Occluders* occluders, PRIVATE int* stopped) {
  Shears shears;
  shear_shadow_rays(paths, i, &shears);
  const int known = occluders->count;
  occluders->count = 0;
  for (int k = 0; k < known; k++) {
    int by_this[LANES], any = 0;
    stop_by_triangle(scene, occluders->triangles[k], paths, i, &shears, by_this);
    for (int j = 0; j < LANES; j++) any |= by_this[j];
    for (int j = 0; j < LANES; j++) stopped[j] |= by_this[j];
    occluders->triangles[occluders->count] = occluders->triangles[k];
    occluders->count += any;
  }
}

/// Finds how much of the light of each lane's shadow ray gets through, see shares_occluders: all or nothing.
STAGE void occlude_by_neighbours(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  const int triangle_count = scene->header.tables.triangles.count;
  Occluders occluders;
  occluders.count = 0;
  for (int i = 0; i < count; i += LANES) {
    int stopped[LANES];
    for (int j = 0; j < LANES; j++) stopped[j] = 0;
    if (occluders.count > 0) stop_by_occluders(scene, paths, i, &occluders, stopped);
    for (int j = 0; j < LANES && i + j < count; j++) {
      if (stopped[j] == 0) {
        const int by = occlude_bvh(scene, get_shadow_origin(paths, i + j), get_shadow_direction(paths, i + j),
                                   get_shadow_tmax(paths, i + j), get_shadow_skip(paths, i + j))
                           .primitive;
        stopped[j] = by >= 0 ? 1 : 0;
        bool is_new = (by >= 0) & (by < triangle_count) & (occluders.count < MOST_OCCLUDERS);
        for (int k = 0; k < occluders.count; k++) is_new = is_new & (occluders.triangles[k] != by);
        if (is_new) occluders.triangles[occluders.count++] = by;
      }
      set_shadow_transmittance(paths, i + j, stopped[j] != 0 ? 0.0f : 1.0f);
    }
  }
}
#endif

PENUMBRA_NAMESPACE_END
#endif
