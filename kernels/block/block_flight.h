// Many rays through the hierarchy at a time, each in turn a step, while what the others visit next is on its
// way from memory. Rays wait in one list for their node and in another for their leaf, so that no processor
// has to guess which it is (after Wald, Benthin and Boulos 2008, Getting Rid of Packets, who filter streams
// of rays by what they do next). Rays that stay together all the way, a camera's, are faster one by one:
// their branches are guessed rightly, and what they visit is there already.
#ifndef PENUMBRA_BLOCK_FLIGHT_H
#define PENUMBRA_BLOCK_FLIGHT_H
#include "kernels/block/path_state.h"
#include "kernels/intersect/bvh_flight.h"
#include "kernels/intersect/surface.h"

PENUMBRA_NAMESPACE_BEGIN

/// The share of light that passes the primitive, if that is known without a look at the place: 1 where there
/// is none, 0 if none passes; else negative.
FN float share_behind(const PRIVATE Scene* scene, int primitive) {
  const SideMaterials sides = side_materials(scene, primitive);
  const int front = scene->materials[sides.front].passes, back = scene->materials[sides.back].passes;
  return primitive < 0 ? 1.0f : ((front | back) != PASSES_NONE ? -1.0f : 0.0f);
}

/// How much of the light of a shadow ray gets through, of which `primitive` is some hit or -1: negative where
/// what stops it may let some through.
FN void set_transmittance_of_hit(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                 int primitive) {
  float share = primitive < 0 ? 1.0f : 0.0f;
  if (NEEDS(scene, NESTED)) share = share_behind(scene, primitive);
  set_shadow_transmittance(paths, i, share);
}

#ifdef RAYS_IN_FLIGHT
  #define CACHE_LINE 64

/// Those that come next to a node, those that come to a leaf, and those that have ended. A place more, as
/// every ray is written behind every list.
typedef struct {
  int nodes[RAYS_IN_FLIGHT + 1], leaves[RAYS_IN_FLIGHT + 1], ended[RAYS_IN_FLIGHT + 1];
} FlightLists;
typedef struct {
  int nodes, leaves, ended;
} FlightCounts;

/// Lists the ray by what it visits next, and asks for that.
FN void list_flight(const PRIVATE Scene* scene, PRIVATE FlightLists* next, PRIVATE FlightCounts* counts,
                    int k, const PRIVATE RayInFlight* f) {
  const int entry = f->entry;
  const bool leaf = entry < 0, ended = f->top == 0;
  GLOBAL const char* table =
      leaf ? (GLOBAL const char*)scene->triangle_leaves : (GLOBAL const char*)scene->nodes;
  const ulong record = (ulong)(uint)(leaf ? ~entry : entry) * (leaf ? sizeof(TriangleLeaf) : sizeof(BvhNode));
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

/// The ray of a path, or its shadow ray, of which any hit will do.
FN void start_ray_of(PRIVATE RayInFlight* f, const PRIVATE PathState* paths, int i, bool shadow) {
  if (shadow)
    start_flight(f, get_shadow_origin(paths, i), get_shadow_direction(paths, i), get_shadow_tmax(paths, i),
                 get_shadow_skip(paths, i), i);
  else
    start_flight(f, get_ray_origin(paths, i), get_ray_direction(paths, i), get_ray_tmax(paths, i),
                 get_ray_skip(paths, i), i);
}

/// Traces the rays of `count` listed paths, which get their hits, or the transmittances of their shadow rays.
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
