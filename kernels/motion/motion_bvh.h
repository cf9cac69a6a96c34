// Traversal of the hierarchy of what moves, by one ray at its time. The boxes of a node are linear in time. A
// child may stand for a part of the time only: what moves far has several small boxes instead of a large one
// (Woop, Afra and Benthin 2017, "STBVH: a spatial-temporal BVH for efficient multi-segment motion blur").
#ifndef PENUMBRA_MOTION_BVH_H
#define PENUMBRA_MOTION_BVH_H
#include "kernels/intersect/bvh.h"
#include "kernels/motion/motion.h"

PENUMBRA_NAMESPACE_BEGIN

/// Like enter_children, for the boxes at `time`.
FN uint enter_moving_children(GLOBAL const MotionNode* node, const PRIVATE BvhRay* r, float time, int end,
                              PRIVATE int* keys) {
  // The rows of `low` and `high` are in the order of BvhNode's bounds, and so are those of the speeds.
  GLOBAL const float* rows = node->low[0];
  const uint speed = 6u * BVH_WIDTH;
  GLOBAL const float* nx = rows + r->near_x;
  GLOBAL const float* ny = rows + r->near_y;
  GLOBAL const float* nz = rows + r->near_z;
  GLOBAL const float* fx = rows + ((0u + 3u) * BVH_WIDTH - r->near_x);
  GLOBAL const float* fy = rows + ((1u + 4u) * BVH_WIDTH - r->near_y);
  GLOBAL const float* fz = rows + ((2u + 5u) * BVH_WIDTH - r->near_z);
  GLOBAL const float* begin = node->begin;
  GLOBAL const float* stop = node->end;
  const vec3 o = r->o;
  const vec3 in = make_vec3(r->ix, r->iy, r->iz), out = make_vec3(r->fx, r->fy, r->fz);
  const float limit = BITS_FLOAT(end);
  REGISTER_ARRAY int entered[BVH_WIDTH];
  REGISTER_LOOP(BVH_WIDTH)
  for (int j = 0; j < BVH_WIDTH; j++) {
    const float near_x = nx[j] + time * nx[speed + j], far_x = fx[j] + time * fx[speed + j];
    const float near_y = ny[j] + time * ny[speed + j], far_y = fy[j] + time * fy[speed + j];
    const float near_z = nz[j] + time * nz[speed + j], far_z = fz[j] + time * fz[speed + j];
    const float t0 =
        max_f(max_f((near_x - o.x) * in.x, (near_y - o.y) * in.y), max_f((near_z - o.z) * in.z, 0.0f));
    const float t1 =
        min_f(min_f((far_x - o.x) * out.x, (far_y - o.y) * out.y), min_f((far_z - o.z) * out.z, limit));
    const bool enters = (t0 <= t1) & (time >= begin[j]) & (time <= stop[j]);
    keys[j] = enters ? (((int)FLOAT_BITS(t0) & ~KEY_CHILD) | j) : NO_KEY;
    entered[j] = enters ? 1 : 0;
  }
  return mask_of_8(entered);
}

/// A ray at a time, among what moves.
typedef struct {
  BvhRay ray;
  float time;
  int skip, skip_instance;  ///< the primitive that it must not hit, and its instance, or -1
  bool any;                 ///< any hit is as good as the closest
} MovingRay;

/// The closest of `best` and the hits in an instance.
FN Hit intersect_moving_instance(const PRIVATE Scene* scene, int instance, const PRIVATE MovingRay* r,
                                 Hit best) {
  const Instance at = instance_of(scene, instance, r->time);
  const GroupRay inside = group_ray(at, r->ray.o, r->ray.d);
  const int root = scene->groups[at.group].root, skip = instance == r->skip_instance ? r->skip : -1;
  const Hit found = r->any
                        ? occlude_subtree(scene, root, inside.o, inside.d, best.t, skip, -1, false, true)
                        : intersect_subtree(scene, root, inside.o, inside.d, best.t, skip, -1, false, true);
  if (found.primitive < 0) return best;
  best = found;
  best.instance = instance;
  return best;
}

/// Bit j of the result is set if the ray hits triangle j of the leaf in (0, limit], even if it is the skipped
/// one. distances[j] has the bits of the distance, or NO_KEY. As triangle_leaf_hits, with vertices as
/// triangle_at has them.
FN uint moving_triangle_hits(GLOBAL const MotionLeaf* leaf, const PRIVATE MovingRay* r, float limit,
                             PRIVATE int* distances) {
  const Between b = between_states(consecutive_states(leaf->steps), r->time);
  // The end of the leaf's time is the beginning of the next step.
  const bool ends = b.from >= leaf->last_step;
  const int from = (ends ? leaf->last_step - 1 : b.from) - leaf->first_step;
  const float f = ends ? 1.0f : b.f;
  const Shear s = r->ray.shear;
  const float ox = r->ray.ox, oy = r->ray.oy, oz = r->ray.oz;
  const uint kx = r->ray.kx, ky = r->ray.ky, kz = r->ray.kz;
  GLOBAL const float* a = leaf[from].p[0][0];  // the rows of a vertex are consecutive
  GLOBAL const float* c = leaf[from + 1].p[0][0];
  const uint vertex = 3u * BVH_WIDTH;
  REGISTER_ARRAY int inside[BVH_WIDTH];
  REGISTER_LOOP(BVH_WIDTH)
  for (int j = 0; j < BVH_WIDTH; j++) {
    const float x0 = float_between(a[kx + j], c[kx + j], f), y0 = float_between(a[ky + j], c[ky + j], f);
    const float z0 = float_between(a[kz + j], c[kz + j], f);
    const float x1 = float_between(a[vertex + kx + j], c[vertex + kx + j], f);
    const float y1 = float_between(a[vertex + ky + j], c[vertex + ky + j], f);
    const float z1 = float_between(a[vertex + kz + j], c[vertex + kz + j], f);
    const float x2 = float_between(a[2u * vertex + kx + j], c[2u * vertex + kx + j], f);
    const float y2 = float_between(a[2u * vertex + ky + j], c[2u * vertex + ky + j], f);
    const float z2 = float_between(a[2u * vertex + kz + j], c[2u * vertex + kz + j], f);
    const TriangleHit h = intersect_sheared(shear_permuted(s, x0 - ox, y0 - oy, z0 - oz),
                                            shear_permuted(s, x1 - ox, y1 - oy, z1 - oz),
                                            shear_permuted(s, x2 - ox, y2 - oy, z2 - oz));
    const bool hit = h.inside & (h.t > 0.0f) & (h.t <= limit);
    distances[j] = hit ? (int)FLOAT_BITS(h.t) : NO_KEY;
    inside[j] = hit ? 1 : 0;
  }
  return mask_of_8(inside);
}

/// The closest of `best` and a hit of what is no instance.
FN Hit closer_moving_hit(Hit best, float t, int primitive) {
  Hit closer = closer_hit(best, t, primitive);
  closer.instance = closer.primitive == primitive ? -1 : best.instance;
  return closer;
}

/// An instance is alone in its leaf.
FN Hit intersect_moving_leaf(const PRIVATE Scene* scene, int leaf, const PRIVATE MovingRay* r, Hit best) {
  GLOBAL const MotionLeaf* members = scene->motion_leaves + leaf;
  if (HAS(INSTANCES) && members->instance[0] >= 0)
    return intersect_moving_instance(scene, members->instance[0], r, best);
  const int skip = r->skip_instance < 0 ? r->skip : -1;
  if (scene->header.tables.triangle_motions.count > 0) {
    REGISTER_ARRAY int distances[BVH_WIDTH];
    for (uint hits = moving_triangle_hits(members, r, best.t, distances); hits != 0u; hits &= hits - 1u) {
      const int j = LOWEST_BIT(hits), primitive = members->primitive[j];
      if (primitive != skip) best = closer_moving_hit(best, BITS_FLOAT((uint)distances[j]), primitive);
    }
  }
  if (!HAS(QUADRICS) || scene->header.tables.quadric_motions.count == 0) return best;
  for (int j = 0; j < BVH_WIDTH; j++) {
    const int primitive = members->primitive[j];
    const int quadric = primitive - scene->header.tables.triangles.count;
    if (quadric < 0 || primitive == skip) continue;
    const float t = intersect_quadric(quadric_at(scene, quadric, r->time), r->ray.o, r->ray.d);
    if (t > 0.0f) best = closer_moving_hit(best, t, primitive);
  }
  return best;
}

/// The closest hit in (0, tmax) of what moves, or any hit; except primitive `skip` of `skip_instance`, which
/// are -1 for none.
CALLED_FN Hit intersect_moving(const PRIVATE Scene* scene, vec3 o, vec3 d, float tmax, int skip,
                               int skip_instance, float time, bool any) {
  int stack[BVH_STACK], distances[BVH_STACK];
  REGISTER_ARRAY int entries[BVH_WIDTH];
  Hit best = no_hit(tmax);
  if (tmax < 0.0f) return best;
  MovingRay r;
  r.ray = make_bvh_ray(o, d, -1);
  r.time = time;
  r.skip = skip;
  r.skip_instance = skip_instance;
  r.any = any;
  int top = 0, entry = 0, end = key_of_end(tmax);
  for (;;) {
    if (entry >= 0) {
      GLOBAL const MotionNode* node = scene->motion_nodes + entry;
      // The nearest child is visited next; the others go on the stack by decreasing distance.
      const int base = top;
      for (uint hits = enter_moving_children(node, &r.ray, time, end, entries); hits != 0u;
           hits &= hits - 1u) {
        const int j = LOWEST_BIT(hits);
        int place = top++;
        for (; place > base && distances[place - 1] < entries[j]; place--) {
          distances[place] = distances[place - 1];
          stack[place] = stack[place - 1];
        }
        distances[place] = entries[j];
        stack[place] = node->child[j];
      }
    } else {
      best = intersect_moving_leaf(scene, ~entry, &r, best);
      if (any & (best.primitive >= 0)) return best;
      end = key_of_end(best.t);
    }
    do {
      if (top == 0) return best;
      entry = stack[--top];
    } while (distances[top] > end);
  }
}

PENUMBRA_NAMESPACE_END
#endif
