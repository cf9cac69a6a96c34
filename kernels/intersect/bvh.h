// Traversal of the wide BVH by one ray, BVH_WIDTH children or triangles at a time.
#ifndef PENUMBRA_BVH_H
#define PENUMBRA_BVH_H
#include "kernels/intersect/bvh_limits.h"
#include "kernels/intersect/instance.h"
#include "kernels/intersect/quadric.h"
#include "kernels/intersect/triangle.h"

PENUMBRA_NAMESPACE_BEGIN

// Levels: the scene's BVH, and inside an instance that of its group.
#define BVH_LEVELS (HAS(INSTANCES) ? 2 : 1)
#define BVH_STACK (BVH_LEVELS * (BVH_MAX_DEPTH * (BVH_WIDTH - 1) + BVH_WIDTH))
// 1 + 2 gamma(3): with it a slab test never misses a box by rounding (Ize 2013).
#define SLAB_MARGIN 1.0000005f

typedef struct {
  int primitive;  ///< -1: no hit before tmax
  float t;
  int instance;  ///< the instance of the primitive, or -1
} Hit;

FN Hit closer_hit(Hit best, float t, int primitive) {
  bool closer = (t < best.t) | ((t == best.t) & (primitive < best.primitive));
  best.primitive = closer ? primitive : best.primitive;
  best.t = closer ? t : best.t;
  return best;
}

/// A ray, prepared for traversal.
typedef struct {
  vec3 o, d;
  float ix, iy, iz;             ///< 1 / d
  float fx, fy, fz;             ///< 1 / d times SLAB_MARGIN: the exit distance of a box is never too small
  uint near_x, near_y, near_z;  ///< offsets of the rows of a node's bounds that the ray meets first
  Shear shear;
  uint kx, ky, kz;   ///< offsets of the rows of a leaf's vertices for the axes of the sheared space
  float ox, oy, oz;  ///< the origin, in the order of those axes
  int skip;          ///< a primitive that the ray must not hit, or -1
} BvhRay;

FN BvhRay make_bvh_ray(vec3 o, vec3 d, int skip) {
  BvhRay r;
  r.o = o;
  r.d = d;
  r.ix = 1.0f / d.x;
  r.iy = 1.0f / d.y;
  r.iz = 1.0f / d.z;
  r.fx = r.ix * SLAB_MARGIN;
  r.fy = r.iy * SLAB_MARGIN;
  r.fz = r.iz * SLAB_MARGIN;
  r.near_x = (r.ix < 0.0f ? 3u : 0u) * BVH_WIDTH;
  r.near_y = (r.iy < 0.0f ? 4u : 1u) * BVH_WIDTH;
  r.near_z = (r.iz < 0.0f ? 5u : 2u) * BVH_WIDTH;
  // The same as make_shear without selects: the axis is unpredictable.
  const float from[3] = {o.x, o.y, o.z}, to[3] = {d.x, d.y, d.z};
  const int kz = largest_axis(d), kx = kz == 2 ? 0 : kz + 1, ky = kx == 2 ? 0 : kx + 1;
  r.shear.axis = kz;
  r.shear.z = 1.0f / to[kz];
  r.shear.x = to[kx] * r.shear.z;
  r.shear.y = to[ky] * r.shear.z;
  r.kx = (uint)kx * BVH_WIDTH;
  r.ky = (uint)ky * BVH_WIDTH;
  r.kz = (uint)kz * BVH_WIDTH;
  r.ox = from[kx];
  r.oy = from[ky];
  r.oz = from[kz];
  r.skip = skip;
  return r;
}

// Keys order children along a ray. A key is the bits of the entry distance (as integers they are in the order
// of the distances), with the child's number in the lowest bits. NO_KEY: the ray does not enter the child.
#define KEY_CHILD (BVH_WIDTH - 1)
#define NO_KEY 0x7fffffff

/// The largest key of children that are visited if the ray ends at t. The distances of a triangle and of its
/// box are rounded differently: the margin makes sure that all triangles as near as the nearest are tested,
/// whatever the order of leaves, so that the hit is the same as if all were tested.
#define END_MARGIN 1.0000153f  // 1 + 2^-16
FN int key_of_end(float t) { return (int)FLOAT_BITS(t * END_MARGIN); }

/// Bit j of the result is set if the ray enters child j before `end` (see key_of_end); keys[j] is the child's
/// key.
FN uint enter_children(GLOBAL const BvhNode* node, const PRIVATE BvhRay* r, int end, PRIVATE int* keys) {
  GLOBAL const float* rows = node->bounds[0];
  GLOBAL const float* nx = rows + r->near_x;
  GLOBAL const float* ny = rows + r->near_y;
  GLOBAL const float* nz = rows + r->near_z;
  GLOBAL const float* fx = rows + ((0u + 3u) * BVH_WIDTH - r->near_x);
  GLOBAL const float* fy = rows + ((1u + 4u) * BVH_WIDTH - r->near_y);
  GLOBAL const float* fz = rows + ((2u + 5u) * BVH_WIDTH - r->near_z);
  const vec3 o = r->o;
  const vec3 in = make_vec3(r->ix, r->iy, r->iz), out = make_vec3(r->fx, r->fy, r->fz);
  const float limit = BITS_FLOAT(end);
  REGISTER_ARRAY int entered[BVH_WIDTH];
  // If 0 * infinity gives NaN, comparisons keep the other operand or none: such a box is visited, never
  // missed.
  REGISTER_LOOP(BVH_WIDTH)
  for (int j = 0; j < BVH_WIDTH; j++) {
    const float t0 =
        max_f(max_f((nx[j] - o.x) * in.x, (ny[j] - o.y) * in.y), max_f((nz[j] - o.z) * in.z, 0.0f));
    const float t1 =
        min_f(min_f((fx[j] - o.x) * out.x, (fy[j] - o.y) * out.y), min_f((fz[j] - o.z) * out.z, limit));
    const bool enters = t0 <= t1;
    keys[j] = enters ? (((int)FLOAT_BITS(t0) & ~KEY_CHILD) | j) : NO_KEY;
    entered[j] = enters ? 1 : 0;
  }
  return mask_of_8(entered);
}

/// Bit j of the result is set if the ray hits triangle j in (0, limit], even if it is the skipped one.
/// distances[j] has the bits of the distance, or NO_KEY.
FN uint triangle_leaf_hits(GLOBAL const TriangleLeaf* leaf, const PRIVATE BvhRay* r, float limit,
                           PRIVATE int* distances) {
  const Shear s = r->shear;
  const float ox = r->ox, oy = r->oy, oz = r->oz;
  GLOBAL const float* a = leaf->p[0][0];  // the rows of a vertex are consecutive
  GLOBAL const float* b = leaf->p[1][0];
  GLOBAL const float* c = leaf->p[2][0];
  GLOBAL const float* ax = a + r->kx;
  GLOBAL const float* ay = a + r->ky;
  GLOBAL const float* az = a + r->kz;
  GLOBAL const float* bx = b + r->kx;
  GLOBAL const float* by = b + r->ky;
  GLOBAL const float* bz = b + r->kz;
  GLOBAL const float* cx = c + r->kx;
  GLOBAL const float* cy = c + r->ky;
  GLOBAL const float* cz = c + r->kz;
  REGISTER_ARRAY int inside[BVH_WIDTH];
  REGISTER_LOOP(BVH_WIDTH)
  for (int j = 0; j < BVH_WIDTH; j++) {
    const TriangleHit h = intersect_sheared(shear_permuted(s, ax[j] - ox, ay[j] - oy, az[j] - oz),
                                            shear_permuted(s, bx[j] - ox, by[j] - oy, bz[j] - oz),
                                            shear_permuted(s, cx[j] - ox, cy[j] - oy, cz[j] - oz));
    const bool hit = h.inside & (h.t > 0.0f) & (h.t <= limit);
    distances[j] = hit ? (int)FLOAT_BITS(h.t) : NO_KEY;
    inside[j] = hit ? 1 : 0;
  }
  return mask_of_8(inside);
}

/// The closest of `best` and the `hits`, without the skipped primitive.
FN Hit closest_of(GLOBAL const TriangleLeaf* leaf, const PRIVATE int* distances, uint hits, int skip,
                  Hit best) {
  for (; hits != 0u; hits &= hits - 1u) {
    const int j = LOWEST_BIT(hits), primitive = leaf->primitive[j];
    if (primitive != skip) best = closer_hit(best, BITS_FLOAT((uint)distances[j]), primitive);
  }
  return best;
}

FN Hit intersect_triangle_leaf(GLOBAL const TriangleLeaf* leaf, const PRIVATE BvhRay* r, Hit best) {
  REGISTER_ARRAY int distances[BVH_WIDTH];
  return closest_of(leaf, distances, triangle_leaf_hits(leaf, r, best.t, distances), r->skip, best);
}

/// Distance in units of the direction's length. `any_length`: this may not be 1.
FN float quadric_distance(const PRIVATE Scene* scene, int primitive, const PRIVATE BvhRay* r,
                          bool any_length) {
  const Quadric q = scene->quadrics[primitive - scene->header.tables.triangles.count];
  if (HAS(INSTANCES) && any_length) {
    const UnitDirection unit = unit_direction(r->d);
    return intersect_quadric(q, r->o, unit.d) / unit.length;
  }
  return intersect_quadric(q, r->o, r->d);
}

/// The closest of the leaf's hits and `best`. `any_length`: see quadric_distance.
FN Hit intersect_leaf(const PRIVATE Scene* scene, int leaf, const PRIVATE BvhRay* r, Hit best,
                      bool any_length) {
  if (HAS(QUADRICS) && leaf >= FIRST_QUADRIC_LEAF) {
    GLOBAL const QuadricLeaf* quadrics = scene->quadric_leaves + (leaf - FIRST_QUADRIC_LEAF);
    for (int j = 0; j < BVH_WIDTH; j++) {
      const int primitive = quadrics->primitive[j];
      if (primitive < 0) continue;
      const float t = quadric_distance(scene, primitive, r, any_length);
      if (t > 0.0f) best = closer_hit(best, t, primitive);
    }
    return best;
  }
  return intersect_triangle_leaf(scene->triangle_leaves + leaf, r, best);
}

FN Hit no_hit(float tmax) {
  Hit none;
  none.primitive = -1;
  none.t = tmax;
  none.instance = -1;
  return none;
}

/// The state of a traversal: in the scene, or inside one of its instances.
typedef struct {
  BvhRay ray;
  BvhRay outside;  ///< the ray in the scene
  int instance;    ///< the current instance, or -1
  int bottom;      ///< bottom of the instance's part of the stack
} Traversal;

/// `instances`: whether the scene has instances. Primitive `skip` of `skip_instance` (-1: not instanced) is
/// not hit.
FN Traversal start_traversal(vec3 o, vec3 d, int skip, int skip_instance, bool instances) {
  Traversal t;
  t.ray = make_bvh_ray(o, d, skip);
  if (HAS(INSTANCES) && instances) {
    t.outside = t.ray;
    t.ray.skip = skip_instance < 0 ? skip : -1;
  }
  t.instance = -1;
  t.bottom = 0;
  return t;
}

/// The instance of a leaf, or a negative number.
FN int instance_of_leaf(int leaf) { return leaf - FIRST_INSTANCE_LEAF; }

/// Enters the instance. Returns the root node of its group.
FN int enter_instance(const PRIVATE Scene* scene, PRIVATE Traversal* t, int instance, int skip_instance,
                      int top) {
  const Instance at = load_instance(scene->instances + instance);
  const GroupRay r = group_ray(at, t->outside.o, t->outside.d);
  t->ray = make_bvh_ray(r.o, r.d, instance == skip_instance ? t->outside.skip : -1);
  t->instance = instance;
  t->bottom = top;
  return scene->groups[at.group].root;
}

/// Leaves the instance if all of it was visited.
FN void leave_instance(PRIVATE Traversal* t, int skip_instance, int top) {
  if (t->instance < 0 || top > t->bottom) return;
  t->ray = t->outside;
  t->ray.skip = skip_instance < 0 ? t->outside.skip : -1;
  t->instance = -1;
}

/// The closest hit in (0, tmax) in the subtree of node `root`, except primitive `skip` of `skip_instance`;
/// both are -1 for none. `instances`: whether it has instances; `any_length`: see quadric_distance. Both are
/// constants, so that the code for them is left out where they are false.
FN Hit intersect_subtree(const PRIVATE Scene* scene, int root, vec3 o, vec3 d, float tmax, int skip,
                         int skip_instance, bool instances, bool any_length) {
  int stack[BVH_STACK], distances[BVH_STACK];
  REGISTER_ARRAY int entries[BVH_WIDTH];
  Hit best = no_hit(tmax);
  if (tmax < 0.0f) return best;
  Traversal at = start_traversal(o, d, skip, skip_instance, instances);
  int top = 0, entry = root, end = key_of_end(tmax);
  for (;;) {
    if (entry >= 0) {
      GLOBAL const BvhNode* node = scene->nodes + entry;
      uint hits = enter_children(node, &at.ray, end, entries);
      if (hits != 0u) {
        // The nearest child is visited next; the others go on the stack by decreasing distance.
        const int base = top;
        int first = LOWEST_BIT(hits);
        int nearest = entries[first];
        entry = node->child[first];
        for (hits &= hits - 1u; hits != 0u; hits &= hits - 1u) {
          const int j = LOWEST_BIT(hits);
          const bool nearer = entries[j] < nearest;
          const int other = nearer ? entry : node->child[j];
          const int distance = nearer ? nearest : entries[j];
          entry = nearer ? node->child[j] : entry;
          nearest = nearer ? entries[j] : nearest;
          int place = top++;
          for (; place > base && distances[place - 1] < distance; place--) {
            distances[place] = distances[place - 1];
            stack[place] = stack[place - 1];
          }
          distances[place] = distance;
          stack[place] = other;
        }
        continue;
      }
    } else {
      const int instance = HAS(INSTANCES) && instances ? instance_of_leaf(~entry) : -1;
      if (HAS(INSTANCES) && instance >= 0) {
        entry = enter_instance(scene, &at, instance, skip_instance, top);
        continue;
      }
      const Hit found = intersect_leaf(scene, ~entry, &at.ray, best, any_length);
      const bool other = (found.primitive != best.primitive) | (found.t != best.t);
      const int before = best.instance;
      best = found;
      if (HAS(INSTANCES)) best.instance = other ? at.instance : before;
      end = key_of_end(best.t);
    }
    do {
      if (HAS(INSTANCES) && instances) leave_instance(&at, skip_instance, top);
      if (top == 0) return best;
      entry = stack[--top];
    } while (distances[top] > end);
  }
}

/// Any hit in (0, tmax); parameters as for intersect_subtree. A node's last child has the fewest primitives
/// and is visited first, since few large primitives occlude most rays. (In the order of distance, clutter
/// around the ray's origin would come first.)
FN Hit occlude_subtree(const PRIVATE Scene* scene, int root, vec3 o, vec3 d, float tmax, int skip,
                       int skip_instance, bool instances, bool any_length) {
  int stack[BVH_STACK];
  REGISTER_ARRAY int entries[BVH_WIDTH];
  const int end = key_of_end(tmax);
  if (tmax < 0.0f) return no_hit(tmax);
  Traversal at = start_traversal(o, d, skip, skip_instance, instances);
  int top = 0;
  stack[top++] = root;
  while (top > 0) {
    int entry = stack[--top];
    const int instance = (HAS(INSTANCES) && instances && entry < 0) ? instance_of_leaf(~entry) : -1;
    if (HAS(INSTANCES) && instance >= 0) entry = enter_instance(scene, &at, instance, skip_instance, top);
    if (entry >= 0) {
      GLOBAL const BvhNode* node = scene->nodes + entry;
      for (uint hits = enter_children(node, &at.ray, end, entries); hits != 0u; hits &= hits - 1u)
        stack[top++] = node->child[LOWEST_BIT(hits)];
    } else {
      const Hit some = intersect_leaf(scene, ~entry, &at.ray, no_hit(tmax), any_length);
      if (some.primitive >= 0) return some;
    }
    if (HAS(INSTANCES) && instances) leave_instance(&at, skip_instance, top);
  }
  return no_hit(tmax);
}

/// In the whole scene; with a constant `instances` only the code that it needs remains.
FN Hit intersect_levels(const PRIVATE Scene* scene, vec3 o, vec3 d, float tmax, int skip, int skip_instance,
                        bool instances) {
  return intersect_subtree(scene, 0, o, d, tmax, skip, skip_instance, instances, instances);
}
FN Hit occlude_levels(const PRIVATE Scene* scene, vec3 o, vec3 d, float tmax, int skip, int skip_instance,
                      bool instances) {
  return occlude_subtree(scene, 0, o, d, tmax, skip, skip_instance, instances, instances);
}

/// For scenes without instances.
FN Hit intersect_bvh(const PRIVATE Scene* scene, vec3 o, vec3 d, float tmax, int skip) {
  return intersect_levels(scene, o, d, tmax, skip, -1, false);
}
FN Hit occlude_bvh(const PRIVATE Scene* scene, vec3 o, vec3 d, float tmax, int skip) {
  return occlude_levels(scene, o, d, tmax, skip, -1, false);
}

PENUMBRA_NAMESPACE_END
#endif
