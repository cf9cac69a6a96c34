// Interleaved traversal: one step of a ray into a node or a leaf, in scenes without instances.
// block/block_flight.h interleaves the steps of several rays. Steps have only branches that are rarely taken,
// which processors predict well. The hits are those of bvh.h.
#ifndef PENUMBRA_BVH_FLIGHT_H
#define PENUMBRA_BVH_FLIGHT_H
#include "kernels/intersect/bvh.h"

PENUMBRA_NAMESPACE_BEGIN

#ifdef RAYS_IN_FLIGHT
  // pack_8 writes a whole register at the top of the stack. The lowest entry marks the end.
  #define FLIGHT_STACK (BVH_MAX_DEPTH * (BVH_WIDTH - 1) + 2 * BVH_WIDTH + 2)

typedef struct {
  BvhRay ray;
  float t;        ///< distance of the closest hit so far
  int primitive;  ///< the primitive of that hit, or -1
  int end;        ///< key_of_end of `t`
  int path;       ///< the path of the ray
  int entry;      ///< node or leaf to visit next
  int top;        ///< its position on the stack; 0: the traversal has ended
  int stack[FLIGHT_STACK];
  int keys[FLIGHT_STACK];  ///< keys of the entries; unused if any hit is wanted
} RayInFlight;

FN void start_flight(PRIVATE RayInFlight* f, vec3 o, vec3 d, float tmax, int skip, int path) {
  f->ray = make_bvh_ray(o, d, skip);
  f->t = tmax;
  f->primitive = -1;
  f->end = key_of_end(tmax);
  f->path = path;
  f->entry = 0;
  f->stack[0] = 0;
  f->keys[0] = 0;
  f->top = 1;
}

/// The next entry is the topmost one that is not beyond the end.
FN void pop_entry(PRIVATE RayInFlight* f, int top, bool any) {
  top--;
  while (!any && f->keys[top] > f->end) top--;
  f->top = top;
  f->entry = f->stack[top];
}

/// The nearest child is next, the others follow by number. For any hit, the last child is next.
FN void step_into_node(const PRIVATE Scene* scene, PRIVATE RayInFlight* f, bool any) {
  GLOBAL const BvhNode* node = scene->nodes + f->entry;
  REGISTER_ARRAY int keys[BVH_WIDTH];
  const uint entered = enter_children(node, &f->ray, f->end, keys);
  int top = f->top;
  if (any) {
    pack_8(f->stack + top, node->child, entered);
    top += BIT_COUNT(entered);
  } else {
    const int least = least_of_8(keys), nearest = least & KEY_CHILD;
    const uint others = entered & ~(1u << nearest);
    pack_8(f->stack + top, node->child, others);
    pack_8(f->keys + top, keys, others);
    top += BIT_COUNT(others);
    f->stack[top] = node->child[nearest];
    f->keys[top] = least;
    top += entered != 0u ? 1 : 0;
  }
  pop_entry(f, top, any);
}

/// Like closest_of. It only loops if the nearest triangle is the skipped one, or one of several at that
/// distance.
FN void find_closest(GLOBAL const TriangleLeaf* leaf, PRIVATE RayInFlight* f) {
  REGISTER_ARRAY int distances[BVH_WIDTH];
  REGISTER_ARRAY int same[BVH_WIDTH];
  const float t = f->t;
  const uint hits = triangle_leaf_hits(leaf, &f->ray, t, distances);
  const int least = least_of_8(distances), best = f->primitive;
  REGISTER_LOOP(BVH_WIDTH)
  for (int j = 0; j < BVH_WIDTH; j++) same[j] = distances[j] == least ? 1 : 0;
  const uint nearest = mask_of_8(same) & hits;
  const int primitive = leaf->primitive[LOWEST_BIT(nearest | (1u << KEY_CHILD))];
  if (((nearest & (nearest - 1u)) != 0u) | ((nearest != 0u) & (primitive == f->ray.skip))) {
    Hit closest = no_hit(t);
    closest.primitive = best;
    closest = closest_of(leaf, distances, hits, f->ray.skip, closest);
    f->t = closest.t;
    f->primitive = closest.primitive;
    return;
  }
  const int end = (int)FLOAT_BITS(t);
  const bool closer = (nearest != 0u) & ((least < end) | (primitive < best));
  f->t = BITS_FLOAT((uint)(closer ? least : end));
  f->primitive = closer ? primitive : best;
}

/// Likewise for any hit. A hit exactly at the end of the ray does not count.
FN void find_any_hit(GLOBAL const TriangleLeaf* leaf, PRIVATE RayInFlight* f) {
  REGISTER_ARRAY int distances[BVH_WIDTH];
  REGISTER_ARRAY int before[BVH_WIDTH];
  const uint hits = triangle_leaf_hits(leaf, &f->ray, f->t, distances);
  const int end = (int)FLOAT_BITS(f->t);
  REGISTER_LOOP(BVH_WIDTH)
  for (int j = 0; j < BVH_WIDTH; j++) before[j] = distances[j] < end ? 1 : 0;
  const uint found = mask_of_8(before);
  const int primitive = leaf->primitive[LOWEST_BIT(found | (1u << KEY_CHILD))];
  f->primitive = found != 0u ? primitive : -1;
  if ((found != 0u) & (primitive == f->ray.skip))
    f->primitive = closest_of(leaf, distances, hits, f->ray.skip, no_hit(f->t)).primitive;
}

FN void step_into_leaf(const PRIVATE Scene* scene, PRIVATE RayInFlight* f, bool any) {
  const int number = ~f->entry;
  if (HAS(QUADRICS) && number >= FIRST_QUADRIC_LEAF) {
    Hit best = no_hit(f->t);
    best.primitive = f->primitive;
    best = intersect_leaf(scene, number, &f->ray, best, false);
    f->t = best.t;
    f->primitive = best.primitive;
  } else if (any)
    find_any_hit(scene->triangle_leaves + number, f);
  else
    find_closest(scene->triangle_leaves + number, f);
  if (!any) f->end = key_of_end(f->t);
  pop_entry(f, (any & (f->primitive >= 0)) ? 1 : f->top, any);
}
#endif

PENUMBRA_NAMESPACE_END
#endif
