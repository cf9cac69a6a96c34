// Intersection without BVH: every ray is tested against every primitive, LANES rays at a time. For small
// scenes this vectorises best. Each distinct vertex is sheared once for all triangles that share it.
#ifndef PENUMBRA_INTERSECT_BRUTE_FORCE_H
#define PENUMBRA_INTERSECT_BRUTE_FORCE_H
#include "kernels/intersect/cull_brute_force.h"
#include "kernels/intersect/quadric.h"
#include "kernels/intersect/triangle.h"

PENUMBRA_NAMESPACE_BEGIN

/// Tests triangle k against the ray of lane j. Only a minimum depends on the triangles before it.
FN void meet_triangle(PRIVATE RayLanes* rays, int j, int k, bool skipped, vec3 a, vec3 b, vec3 c) {
  const TriangleHit h = intersect_sheared(a, b, c);
  const float t = (h.inside & (h.t > 0.0f) & !skipped) ? h.t : INFINITE;
  rays->hit[j] = t < rays->tmax[j] ? k : rays->hit[j];
  rays->tmax[j] = min_f(t, rays->tmax[j]);
}

FN vec3 shear_vertex(const PRIVATE Shears* shears, const PRIVATE RayLanes* rays, int j, vec3 p) {
  return shear_point(load_shear(shears, j),
                     make_vec3(p.x - rays->ox[j], p.y - rays->oy[j], p.z - rays->oz[j]));
}

/// Tests every triangle; each vertex is sheared once.
FN void test_all_primitives(const PRIVATE Scene* scene, const PRIVATE Shears* shears,
                            PRIVATE RayLanes* rays) {
  float vx[MAX_WHOLE_VERTICES * LANES], vy[MAX_WHOLE_VERTICES * LANES], vz[MAX_WHOLE_VERTICES * LANES];
  int before_skip[LANES];  // triangles before `skip`; a countdown, since comparing the loop counter would use
                           // 64 bits
  LANE_LOOP
    for (int j = 0; j < LANES; j++) before_skip[j] = rays->skip[j];
  const int vertex_count = scene->header.tables.vertices.count;
  for (int k = 0; k < vertex_count; k++) {
    const vec3 p = scene->vertices[k];
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        const vec3 v = shear_vertex(shears, rays, j, p);
        vx[k * LANES + j] = v.x;
        vy[k * LANES + j] = v.y;
        vz[k * LANES + j] = v.z;
      }
  }
  const int triangle_count = scene->header.tables.corners.count;
  for (int k = 0; k < triangle_count; k++) {
    const Corner corner = scene->corners[k];
    const int v0 = corner.v0 * LANES, v1 = corner.v1 * LANES, v2 = corner.v2 * LANES;
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        meet_triangle(rays, j, k, before_skip[j] == 0, make_vec3(vx[v0 + j], vy[v0 + j], vz[v0 + j]),
                      make_vec3(vx[v1 + j], vy[v1 + j], vz[v1 + j]),
                      make_vec3(vx[v2 + j], vy[v2 + j], vz[v2 + j]));
        before_skip[j]--;
      }
  }
}

/// Tests the listed triangles.
FN void meet_listed(const PRIVATE Scene* scene, const PRIVATE Shears* shears, PRIVATE RayLanes* rays,
                    const PRIVATE int* listed, int count) {
  for (int n = 0; n < count; n++) {
    const int k = listed[n];
    const Corner corner = scene->corners[k];
    const vec3 p0 = scene->vertices[corner.v0], p1 = scene->vertices[corner.v1],
               p2 = scene->vertices[corner.v2];
    LANE_LOOP
      for (int j = 0; j < LANES; j++)
        meet_triangle(rays, j, k, k == rays->skip[j], shear_vertex(shears, rays, j, p0),
                      shear_vertex(shears, rays, j, p1), shear_vertex(shears, rays, j, p2));
  }
}

FN void intersect_brute_force(const PRIVATE Scene* scene, PRIVATE RayLanes* rays) {
  Shears shears;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      store_shear(&shears, j, make_shear(make_vec3(rays->dx[j], rays->dy[j], rays->dz[j])));
      rays->hit[j] = -1;
    }
  const int triangle_count = scene->header.tables.triangles.count;
  int count = -1;
#if LANES > 1
  int listed[MAX_WHOLE_TRIANGLES];
  count = cull_triangles(scene, rays, listed);
  if (count >= 0) meet_listed(scene, &shears, rays, listed, count);
#endif
  if (count < 0) test_all_primitives(scene, &shears, rays);
  if (HAS(QUADRICS)) {
    const int quadric_count =
        NEEDS_MOTION(scene) ? scene->shutter->still_quadrics : scene->header.tables.quadrics.count;
    for (int k = 0; k < quadric_count; k++) {
      const Quadric q = scene->quadrics[k];
      const int primitive = triangle_count + k;
      if (HAS(CYLINDERS) && q.kind == QUADRIC_CYLINDER) {
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
      LANE_LOOP
        for (int j = 0; j < LANES; j++) {
          float t = intersect_sphere_or_disk(q, make_vec3(rays->ox[j], rays->oy[j], rays->oz[j]),
                                             make_vec3(rays->dx[j], rays->dy[j], rays->dz[j]));
          bool closer = (t > 0.0f) & (t < rays->tmax[j]);
          rays->tmax[j] = closer ? t : rays->tmax[j];
          rays->hit[j] = closer ? primitive : rays->hit[j];
        }
    }
  }
}

PENUMBRA_NAMESPACE_END
#endif
