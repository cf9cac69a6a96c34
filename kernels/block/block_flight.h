// Interleaved traversal of the BVH: many rays are under way at once, and each advances by one node or leaf
// per round. What a ray visits next is prefetched while the others advance. Rays wait in one list for nodes
// and in another for leaves, so that no branch predictor has to guess which it is (after Wald, Benthin and
// Boulos 2008, Getting Rid of Packets, who filter streams of rays by what they do next). Coherent rays, as
// from a camera, are faster one after the other: their branches are predicted well, and what they visit is in
// the cache.
#ifndef PENUMBRA_BLOCK_FLIGHT_H
#define PENUMBRA_BLOCK_FLIGHT_H
#include "kernels/block/path_state.h"
#include "kernels/intersect/bvh_flight.h"
#include "kernels/intersect/surface.h"

PENUMBRA_NAMESPACE_BEGIN

/// The fraction of light that passes a primitive, if it is the same at every point: 1 for no primitive (-1),
/// 0 if its materials pass no light. Negative if it depends on the point.
FN float share_behind(const PRIVATE Scene* scene, int primitive) {
  const SideMaterials sides = side_materials(scene, primitive);
  const int front = scene->materials[sides.front].passes, back = scene->materials[sides.back].passes;
  int passes = front | back;
  if (NEEDS(scene, FLAT_GLASS)) passes |= scene->materials[sides.front].flat_glass;
  return primitive < 0 ? 1.0f : (passes != PASSES_NONE ? -1.0f : 0.0f);
}

/// Sets the transmittance of a shadow ray that hit `primitive`, or nothing if that is -1. Negative if the
/// occluder may let light through.
FN void set_transmittance_of_hit(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                 int primitive) {
  float share = primitive < 0 ? 1.0f : 0.0f;
  if (NEEDS_PASSING_LIGHT(scene)) share = share_behind(scene, primitive);
  set_shadow_transmittance(paths, i, share);
}

#ifdef RAYS_IN_FLIGHT
  #define CACHE_LINE 64

/// Rays that visit a node next, rays that visit a leaf next, and rays that have ended. Each list has one more
/// entry: every ray is written to the end of every list, and only its own list's count advances.
typedef struct {
  int nodes[RAYS_IN_FLIGHT + 1], leaves[RAYS_IN_FLIGHT + 1], ended[RAYS_IN_FLIGHT + 1];
} FlightLists;
typedef struct {
  int nodes, leaves, ended;
} FlightCounts;

/// Adds the ray to the list of its next step, and prefetches what it visits.
FN void list_flight(const PRIVATE Scene* scene, PRIVATE FlightLists* next, PRIVATE FlightCounts* counts,
                    int k, const PRIVATE RayInFlight* f) {
  const int entry = f->entry;
  const bool leaf = entry < 0, ended = f->top == 0;
  GLOBAL const char* table =
      leaf ? (GLOBAL const char*)scene->triangle_leaves : (GLOBAL const char*)scene->nodes;
  const int index = leaf ? ~entry & (FIRST_QUADRIC_LEAF - 1) : entry;
  const ulong record = (ulong)(uint)index * (leaf ? sizeof(TriangleLeaf) : sizeof(BvhNode));
  PREFETCH(table, record);
  PREFETCH(table, record + CACHE_LINE);
  PREFETCH(table, record + 2 * CACHE_LINE);
  PREFETCH(table, record + 3 * CACHE_LINE);
  next->nodes[counts->nodes] = k;
  next->leaves[counts->leaves] = k;
  next->ended[counts->ended] = k;
  counts->nodes += (leaf | ended) ? 0 : 1;
  counts->leaves += leaf ? 1 : 0;
  counts->ended += ended ? 1 : 0;
}

/// Starts the ray of a path, or its shadow ray, for which any hit is enough.
FN void start_ray_of(PRIVATE RayInFlight* f, const PRIVATE PathState* paths, int i, bool shadow) {
  if (shadow)
    start_flight(f, get_shadow_origin(paths, i), get_shadow_direction(paths, i), get_shadow_tmax(paths, i),
                 get_shadow_skip(paths, i), i);
  else
    start_flight(f, get_ray_origin(paths, i), get_ray_direction(paths, i), get_ray_tmax(paths, i),
                 get_ray_skip(paths, i), i);
}

/// Traces the rays of the `count` paths in `listed`. Sets their hits, or the transmittances of their shadow
/// rays.
FN void trace_in_flight(const PRIVATE Scene* scene, const PRIVATE PathState* paths, GLOBAL const int* listed,
                        int count, bool shadow) {
  RayInFlight flight[RAYS_IN_FLIGHT];
  FlightLists lists[2];
  int started = min_i(count, RAYS_IN_FLIGHT), turn = 0;
  for (int k = 0; k < started; k++) {
    start_ray_of(&flight[k], paths, listed[k], shadow);
    lists[0].nodes[k] = k;
  }
  FlightCounts counts = {started, 0, 0};
  while (counts.nodes + counts.leaves > 0) {
    const PRIVATE FlightLists* now = &lists[turn];
    const FlightCounts due = counts;
    turn = 1 - turn;
    PRIVATE FlightLists* next = &lists[turn];
    counts.nodes = counts.leaves = counts.ended = 0;
    for (int i = 0; i < due.nodes; i++) {
      const int k = now->nodes[i];
      step_into_node(scene, &flight[k], shadow);
      list_flight(scene, next, &counts, k, &flight[k]);
    }
    for (int i = 0; i < due.leaves; i++) {
      const int k = now->leaves[i];
      step_into_leaf(scene, &flight[k], shadow);
      list_flight(scene, next, &counts, k, &flight[k]);
    }
    for (int i = 0; i < counts.ended; i++) {
      const int k = next->ended[i];
      if (shadow)
        set_transmittance_of_hit(scene, paths, flight[k].path, flight[k].primitive);
      else
        set_hit(paths, flight[k].path, flight[k].primitive);
      if (started == count) continue;
      start_ray_of(&flight[k], paths, listed[started++], shadow);
      next->nodes[counts.nodes++] = k;
    }
  }
}

STAGE void intersect_in_flight(const PRIVATE Scene* scene, const PRIVATE PathState* paths,
                               GLOBAL const int* listed, int count) {
  trace_in_flight(scene, paths, listed, count, false);
}

STAGE void occlude_in_flight(const PRIVATE Scene* scene, const PRIVATE PathState* paths,
                             GLOBAL const int* listed, int count) {
  trace_in_flight(scene, paths, listed, count, true);
}
#endif

PENUMBRA_NAMESPACE_END
#endif
