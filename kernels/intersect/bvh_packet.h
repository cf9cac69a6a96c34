// Packet traversal: LANES rays, one per lane, visit together what any of them enters, in scenes without
// instances. It is for coherent rays, as from a camera. Boxes only decide what is tested, so the hits are
// those of bvh.h.
#ifndef PENUMBRA_BVH_PACKET_H
#define PENUMBRA_BVH_PACKET_H
#include "kernels/intersect/bvh.h"

PENUMBRA_NAMESPACE_BEGIN

#if LANES > 1
typedef struct {
  float ox[LANES], oy[LANES], oz[LANES];  ///< origins
  float ix[LANES], iy[LANES], iz[LANES];  ///< see BvhRay
  float fx[LANES], fy[LANES], fz[LANES];
  float sx[LANES], sy[LANES], sz[LANES];  ///< shears
  float px[LANES], py[LANES], pz[LANES];  ///< origins, in the order of the sheared space's axes
  float t[LANES];                         ///< end of each ray so far; at most 0: there is no ray
  float end[LANES];                       ///< limit beyond which its boxes are not visited, see END_MARGIN
  int hit[LANES];                         ///< primitive, or -1
  int skip[LANES];
} RayPacket;

/// Prepares a packet for rays whose directions have no zero components. Returns whether all rays meet boxes
/// by the same sides and have the same shear axis as `lead`, one of them. Lanes without a ray are ignored.
STAGE bool prepare_packet(PRIVATE RayPacket* RESTRICT p, const PRIVATE BvhRay* RESTRICT lead,
                          const PRIVATE float* RESTRICT dx, const PRIVATE float* RESTRICT dy,
                          const PRIVATE float* RESTRICT dz) {
  const bool negative_x = lead->ix < 0.0f, negative_y = lead->iy < 0.0f, negative_z = lead->iz < 0.0f;
  const int axis = lead->shear.axis;
  const bool first = axis == 0, second = axis == 1;
  int apart = 0;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 o = make_vec3(p->ox[j], p->oy[j], p->oz[j]), d = make_vec3(dx[j], dy[j], dz[j]);
      const bool signs = ((d.x < 0.0f) == negative_x) & ((d.y < 0.0f) == negative_y) &
                         ((d.z < 0.0f) == negative_z) & (d.x != 0.0f) & (d.y != 0.0f) & (d.z != 0.0f);
      const Shear s = make_shear(d);
      apart |= ((signs & (s.axis == axis)) | (p->t[j] <= 0.0f)) ? 0 : 1;
      p->sx[j] = s.x;
      p->sy[j] = s.y;
      p->sz[j] = s.z;
      p->px[j] = first ? o.y : (second ? o.z : o.x);
      p->py[j] = first ? o.z : (second ? o.x : o.y);
      p->pz[j] = first ? o.x : (second ? o.y : o.z);
      p->ix[j] = 1.0f / d.x;
      p->iy[j] = 1.0f / d.y;
      p->iz[j] = 1.0f / d.z;
      p->fx[j] = p->ix[j] * SLAB_MARGIN;
      p->fy[j] = p->iy[j] * SLAB_MARGIN;
      p->fz[j] = p->iz[j] * SLAB_MARGIN;
      p->end[j] = p->t[j] * END_MARGIN;
      p->hit[j] = -1;
    }
  return apart == 0;
}

/// The smallest entry key of the rays into the box, or NO_KEY if none enters it. `low` and `high` are the
/// corners that the rays meet first and last.
FN int packet_key(const PRIVATE RayPacket* p, vec3 low, vec3 high) {
  int least = NO_KEY;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const float t0 = max_f(max_f((low.x - p->ox[j]) * p->ix[j], (low.y - p->oy[j]) * p->iy[j]),
                             max_f((low.z - p->oz[j]) * p->iz[j], 0.0f));
      const float t1 = min_f(min_f((high.x - p->ox[j]) * p->fx[j], (high.y - p->oy[j]) * p->fy[j]),
                             min_f((high.z - p->oz[j]) * p->fz[j], p->end[j]));
      const int key = t0 <= t1 ? (int)FLOAT_BITS(t0) : NO_KEY;
      least = key < least ? key : least;
    }
  return least;
}

/// Intersects the rays with triangle `k` of the leaf.
FN void intersect_packet_triangle(GLOBAL const TriangleLeaf* leaf, int k, const PRIVATE BvhRay* lead,
                                  PRIVATE RayPacket* p) {
  GLOBAL const float* a = leaf->p[0][0] + k;
  GLOBAL const float* b = leaf->p[1][0] + k;
  GLOBAL const float* c = leaf->p[2][0] + k;
  const float ax = a[lead->kx], ay = a[lead->ky], az = a[lead->kz];
  const float bx = b[lead->kx], by = b[lead->ky], bz = b[lead->kz];
  const float cx = c[lead->kx], cy = c[lead->ky], cz = c[lead->kz];
  const int primitive = leaf->primitive[k];
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      Shear s;
      s.axis = 0;
      s.x = p->sx[j];
      s.y = p->sy[j];
      s.z = p->sz[j];
      const float ox = p->px[j], oy = p->py[j], oz = p->pz[j];
      const TriangleHit h = intersect_sheared(shear_permuted(s, ax - ox, ay - oy, az - oz),
                                              shear_permuted(s, bx - ox, by - oy, bz - oz),
                                              shear_permuted(s, cx - ox, cy - oy, cz - oz));
      const float t = p->t[j];
      const bool closer = (h.t < t) | ((h.t == t) & (primitive < p->hit[j]));
      const bool hit = h.inside & (h.t > 0.0f) & closer & (primitive != p->skip[j]);
      p->t[j] = hit ? h.t : t;
      p->end[j] = hit ? h.t * END_MARGIN : p->end[j];
      p->hit[j] = hit ? primitive : p->hit[j];
    }
}

/// The largest end key of the rays.
FN int packet_end(const PRIVATE RayPacket* p) {
  int farthest = 0;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int end = p->end[j] > 0.0f ? (int)FLOAT_BITS(p->end[j]) : 0;
      farthest = end > farthest ? end : farthest;
    }
  return farthest;
}

STAGE void intersect_packet_leaf(const PRIVATE Scene* scene, int number, const PRIVATE BvhRay* lead,
                                 PRIVATE RayPacket* p, const PRIVATE float* dx, const PRIVATE float* dy,
                                 const PRIVATE float* dz) {
  if (HAS(QUADRICS) && number >= FIRST_QUADRIC_LEAF) {
    for (int j = 0; j < LANES; j++) {
      if (p->t[j] <= 0.0f) continue;
      const BvhRay ray =
          make_bvh_ray(make_vec3(p->ox[j], p->oy[j], p->oz[j]), make_vec3(dx[j], dy[j], dz[j]), p->skip[j]);
      Hit best = no_hit(p->t[j]);
      best.primitive = p->hit[j];
      best = intersect_leaf(scene, number, &ray, best, false);
      p->t[j] = best.t;
      p->end[j] = best.t * END_MARGIN;
      p->hit[j] = best.primitive;
    }
    return;
  }
  GLOBAL const TriangleLeaf* leaf = scene->triangle_leaves + number;
  for (int k = 0; k < BVH_WIDTH && leaf->primitive[k] >= 0; k++) intersect_packet_triangle(leaf, k, lead, p);
}

/// Finds the closest hits of the packet's rays.
STAGE void intersect_packet(const PRIVATE Scene* scene, PRIVATE RayPacket* p, const PRIVATE BvhRay* lead,
                            const PRIVATE float* dx, const PRIVATE float* dy, const PRIVATE float* dz) {
  int stack[BVH_STACK], keys[BVH_STACK];
  int top = 0, entry = 0, end = packet_end(p);
  for (;;) {
    if (entry >= 0) {
      GLOBAL const BvhNode* node = scene->nodes + entry;
      GLOBAL const float* rows = node->bounds[0];
      const int base = top;
      for (int k = 0; k < BVH_WIDTH; k++) {
        const vec3 low = make_vec3(rows[lead->near_x + k], rows[lead->near_y + k], rows[lead->near_z + k]);
        const vec3 high =
            make_vec3(rows[3u * BVH_WIDTH - lead->near_x + k], rows[5u * BVH_WIDTH - lead->near_y + k],
                      rows[7u * BVH_WIDTH - lead->near_z + k]);
        const int key = packet_key(p, low, high);
        if (key == NO_KEY) continue;
        int place = top++;
        for (; place > base && keys[place - 1] < key; place--) {
          keys[place] = keys[place - 1];
          stack[place] = stack[place - 1];
        }
        keys[place] = key;
        stack[place] = node->child[k];
      }
    } else {
      intersect_packet_leaf(scene, ~entry, lead, p, dx, dy, dz);
      end = packet_end(p);
    }
    do {
      if (top == 0) return;
      entry = stack[--top];
    } while (keys[top] > end);
  }
}
#endif

PENUMBRA_NAMESPACE_END
#endif
