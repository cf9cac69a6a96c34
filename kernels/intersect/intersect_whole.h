// Intersection without a hierarchy: every ray against every primitive, LANES rays at a time. For small scenes
// this vectorises best: each distinct vertex is sheared once for all triangles that share it.
#ifndef PENUMBRA_INTERSECT_WHOLE_H
#define PENUMBRA_INTERSECT_WHOLE_H
#include "kernels/intersect/bvh_limits.h"
#include "kernels/intersect/quadric.h"
#include "kernels/intersect/triangle.h"

PENUMBRA_NAMESPACE_BEGIN

/// LANES rays, in arrays that stay in the first-level cache. On return `tmax` is where each ray ends and
/// `hit` the primitive there, or -1.
typedef struct {
  float ox[LANES], oy[LANES], oz[LANES], dx[LANES], dy[LANES], dz[LANES];
  float tmax[LANES];
  int skip[LANES];
  int hit[LANES];
} RayLanes;

#if !HAS(BVH)
FN void intersect_whole(const PRIVATE Scene* scene, PRIVATE RayLanes* rays) {
  Shears shears;
  float vx[MAX_WHOLE_VERTICES * LANES], vy[MAX_WHOLE_VERTICES * LANES], vz[MAX_WHOLE_VERTICES * LANES];
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      store_shear(&shears, j, make_shear(make_vec3(rays->dx[j], rays->dy[j], rays->dz[j])));
      rays->hit[j] = -1;
    }
  const int vertex_count = scene->header.tables.vertices.count;
  for (int k = 0; k < vertex_count; k++) {
    const vec3 p = scene->vertices[k];
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        const Shear s = load_shear(&shears, j);
        vec3 v = shear_point(s, make_vec3(p.x - rays->ox[j], p.y - rays->oy[j], p.z - rays->oz[j]));
        vx[k * LANES + j] = v.x;
        vy[k * LANES + j] = v.y;
        vz[k * LANES + j] = v.z;
      }
  }
  const int triangle_count = scene->header.tables.triangles.count;
  for (int k = 0; k < triangle_count; k++) {
    const Corner corner = scene->corners[k];
    const int v0 = corner.v0 * LANES, v1 = corner.v1 * LANES, v2 = corner.v2 * LANES;
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        TriangleHit h = intersect_sheared(make_vec3(vx[v0 + j], vy[v0 + j], vz[v0 + j]),
                                          make_vec3(vx[v1 + j], vy[v1 + j], vz[v1 + j]),
                                          make_vec3(vx[v2 + j], vy[v2 + j], vz[v2 + j]));
        bool closer = h.inside & (h.t > 0.0f) & (h.t < rays->tmax[j]) & (k != rays->skip[j]);
        rays->tmax[j] = closer ? h.t : rays->tmax[j];
        rays->hit[j] = closer ? k : rays->hit[j];
      }
  }
  #if HAS(QUADRICS)
  const int quadric_count = scene->header.tables.quadrics.count;
  for (int k = 0; k < quadric_count; k++) {
    const Quadric q = scene->quadrics[k];
    const int primitive = triangle_count + k;
    #if HAS(CYLINDERS)
    if (q.kind == QUADRIC_CYLINDER) {
      LANE_LOOP
        for (int j = 0; j < LANES; j++) {
          const float t = intersect_cylinder(make_vec3(rays->ox[j], rays->oy[j], rays->oz[j]),
                                             make_vec3(rays->dx[j], rays->dy[j], rays->dz[j]), q.center,
                                             q.normal, q.radius, q.length);
          const bool closer = (t > 0.0f) & (t < rays->tmax[j]);
          rays->tmax[j] = closer ? t : rays->tmax[j];
          rays->hit[j] = closer ? primitive : rays->hit[j];
        }
      continue;
    }
    #endif
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        float t = intersect_sphere_or_disk(q, make_vec3(rays->ox[j], rays->oy[j], rays->oz[j]),
                                           make_vec3(rays->dx[j], rays->dy[j], rays->dz[j]));
        bool closer = (t > 0.0f) & (t < rays->tmax[j]);
        rays->tmax[j] = closer ? t : rays->tmax[j];
        rays->hit[j] = closer ? primitive : rays->hit[j];
      }
  }
  #endif
}
#endif

PENUMBRA_NAMESPACE_END
#endif
