// One ray through the wide bounding volume hierarchy, BVH_WIDTH children or triangles at a time.
#ifndef PENUMBRA_BVH_H
#define PENUMBRA_BVH_H
#include "kernels/bvh_limits.h"
#include "kernels/quadric.h"
#include "kernels/triangle.h"

PENUMBRA_NAMESPACE_BEGIN

#define BVH_STACK (BVH_MAX_DEPTH * (BVH_WIDTH - 1) + 2)
// 1 + 2 gamma(3): a slab test that never misses a box through rounding (Ize 2013).
#define SLAB_MARGIN 1.0000005f

typedef struct {
  int primitive;  ///< -1: nothing before tmax
  float t;
} Hit;

FN Hit closer_hit(Hit best, float t, int primitive) {
  bool closer = (t < best.t) | ((t == best.t) & (primitive < best.primitive));
  best.primitive = closer ? primitive : best.primitive;
  best.t = closer ? t : best.t;
  return best;
}

FN Hit intersect_triangle_leaf(GLOBAL const TriangleLeaf* leaf, vec3 o, Shear s, int skip, Hit best) {
  float ts[BVH_WIDTH];
  int hits[BVH_WIDTH];
  const int kx = s.axis == 2 ? 0 : s.axis + 1;
  const int ky = kx == 2 ? 0 : kx + 1;
  const int kz = s.axis;
  const float ox = kx == 0 ? o.x : (kx == 1 ? o.y : o.z);
  const float oy = ky == 0 ? o.x : (ky == 1 ? o.y : o.z);
  const float oz = kz == 0 ? o.x : (kz == 1 ? o.y : o.z);
  GLOBAL const float* ax = leaf->p[0][kx];
  GLOBAL const float* ay = leaf->p[0][ky];
  GLOBAL const float* az = leaf->p[0][kz];
  GLOBAL const float* bx = leaf->p[1][kx];
  GLOBAL const float* by = leaf->p[1][ky];
  GLOBAL const float* bz = leaf->p[1][kz];
  GLOBAL const float* cx = leaf->p[2][kx];
  GLOBAL const float* cy = leaf->p[2][ky];
  GLOBAL const float* cz = leaf->p[2][kz];
  LANE_LOOP_WIDTH(8)
  for (int j = 0; j < BVH_WIDTH; j++) {
    TriangleHit h = intersect_sheared(shear_permuted(s, ax[j] - ox, ay[j] - oy, az[j] - oz),
                                      shear_permuted(s, bx[j] - ox, by[j] - oy, bz[j] - oz),
                                      shear_permuted(s, cx[j] - ox, cy[j] - oy, cz[j] - oz));
    int primitive = leaf->primitive[j];
    ts[j] = h.t;
    hits[j] = (h.inside & (h.t > 0.0f) & (h.t < NO_LIMIT) & (primitive != skip) & (primitive >= 0)) ? 1 : 0;
  }
  for (int j = 0; j < BVH_WIDTH; j++)
    if (hits[j]) best = closer_hit(best, ts[j], leaf->primitive[j]);
  return best;
}

/// The closest hit in (0, tmax), or with `any` some hit.
FN Hit intersect_bvh(const PRIVATE Scene* scene, vec3 o, vec3 d, float tmax, int skip, bool any) {
  int stack[BVH_STACK];
  float distances[BVH_STACK];
  Hit best;
  best.primitive = -1;
  best.t = tmax;
  if (tmax < 0.0f) return best;
  const Shear shear = make_shear(d);
  const float ix = 1.0f / d.x, iy = 1.0f / d.y, iz = 1.0f / d.z;
  int top = 0;
  stack[top] = 0;
  distances[top++] = 0.0f;
  while (top > 0) {
    const int entry = stack[--top];
    if (distances[top] > best.t) continue;
    if (entry >= 0) {
      GLOBAL const BvhNode* node = scene->nodes + entry;
      GLOBAL const float* near_x = ix < 0.0f ? node->high_x : node->low_x;
      GLOBAL const float* far_x = ix < 0.0f ? node->low_x : node->high_x;
      GLOBAL const float* near_y = iy < 0.0f ? node->high_y : node->low_y;
      GLOBAL const float* far_y = iy < 0.0f ? node->low_y : node->high_y;
      GLOBAL const float* near_z = iz < 0.0f ? node->high_z : node->low_z;
      GLOBAL const float* far_z = iz < 0.0f ? node->low_z : node->high_z;
      float entries[BVH_WIDTH];
      int hits[BVH_WIDTH];
      const float limit = best.t;
      // Comparisons with the NaN of 0 * infinity keep the other operand or none: such a box is visited, never
      // missed.
      LANE_LOOP_WIDTH(8)
      for (int j = 0; j < BVH_WIDTH; j++) {
        float nx = (near_x[j] - o.x) * ix, ny = (near_y[j] - o.y) * iy, nz = (near_z[j] - o.z) * iz;
        float fx = (far_x[j] - o.x) * ix, fy = (far_y[j] - o.y) * iy, fz = (far_z[j] - o.z) * iz;
        float t0 = max_f(max_f(max_f(nx, ny), nz), 0.0f);
        float t1 = min_f(min_f(min_f(fx, fy), fz) * SLAB_MARGIN, limit);
        entries[j] = t0;
        hits[j] = t0 <= t1 ? 1 : 0;
      }
      const int base = top;
      for (int j = 0; j < BVH_WIDTH; j++) {
        if (!hits[j]) continue;
        int k = top++;  // insertion sort: the nearest child ends on top
        for (; k > base && distances[k - 1] < entries[j]; k--) {
          distances[k] = distances[k - 1];
          stack[k] = stack[k - 1];
        }
        distances[k] = entries[j];
        stack[k] = node->child[j];
      }
    } else {
      const int leaf = ~entry;
      if (leaf < scene->header.triangle_leaf_count) {
        best = intersect_triangle_leaf(scene->triangle_leaves + leaf, o, shear, skip, best);
      }
#if HAS(QUADRICS)
      else {
        GLOBAL const QuadricLeaf* quadrics =
            scene->quadric_leaves + (leaf - scene->header.triangle_leaf_count);
        for (int j = 0; j < BVH_WIDTH; j++) {
          const int primitive = quadrics->primitive[j];
          if (primitive < 0) continue;
          float t = intersect_quadric(scene->quadrics[primitive - scene->header.triangle_count], o, d);
          if (t > 0.0f) best = closer_hit(best, t, primitive);
        }
      }
#endif
      if (any && best.primitive >= 0) return best;
    }
  }
  return best;
}

PENUMBRA_NAMESPACE_END
#endif
