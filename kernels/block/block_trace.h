// The stages of a block that trace rays: intersect, occlude, and adding the light of unoccluded shadow rays.
#ifndef PENUMBRA_BLOCK_TRACE_H
#define PENUMBRA_BLOCK_TRACE_H
#include "kernels/block/block_flight.h"
#include "kernels/block/block_instances.h"
#include "kernels/block/block_motion.h"
#include "kernels/block/path_state.h"
#include "kernels/intersect/bvh.h"
#include "kernels/intersect/bvh_packet.h"
#include "kernels/intersect/intersect_brute_force.h"
#include "kernels/intersect/surface.h"

PENUMBRA_NAMESPACE_BEGIN

/// Counts the rays of `count` paths, and the shadow rays that their step requests.
STAGE void count_rays(const PRIVATE PathState* paths, int count, GLOBAL TracedRays* traced) {
  int shadow_rays = 0;
  for (int i = 0; i < count; i++) shadow_rays += get_shadow_tmax(paths, i) > 0.0f ? 1 : 0;
  traced->rays += (ulong)count;
  traced->shadow_rays += (ulong)shadow_rays;
}

/// Whether any of LANES paths from lane i on has a ray.
FN bool any_ray(const PRIVATE PathState* paths, int i) {
  int any = 0;
  for (int j = i; j < i + LANES; j++) any |= get_ray_tmax(paths, j) > 0.0f ? 1 : 0;
  return any != 0;
}

/// For intersectors that do not report the occluder: it may let light through, so the transmittance becomes
/// negative (unknown).
STAGE void doubt_occluded(const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i++)
    if (!(get_shadow_transmittance(paths, i) > 0.0f)) set_shadow_transmittance(paths, i, -1.0f);
}

/// Lists the lanes that have a shadow ray, padded to a multiple of LANES by repeating the last one. Returns
/// their number.
STAGE int list_shadow_rays(const PRIVATE PathState* paths, int count, GLOBAL int* RESTRICT wanted) {
  int n = 0;
  for (int i = 0; i < count; i++) {  // no branch: which paths have one is unpredictable
    wanted[n] = i;
    n += get_shadow_tmax(paths, i) > 0.0f ? 1 : 0;
  }
  const int last = n > 0 ? wanted[n - 1] : 0;
  for (int i = n; i % LANES != 0; i++) wanted[i] = last;
  return n;
}

#ifdef RAYS_IN_FLIGHT
/// Lists the lanes that have a ray. All hits become -1.
STAGE int list_rays(const PRIVATE PathState* paths, int count, GLOBAL int* RESTRICT wanted) {
  int n = 0;
  for (int i = 0; i < count; i++) {
    wanted[n] = i;
    n += get_ray_tmax(paths, i) > 0.0f ? 1 : 0;
    set_hit(paths, i, -1);
  }
  return n;
}
#endif

FN void load_lane_ray(PRIVATE RayLanes* rays, int j, vec3 origin, vec3 direction, float tmax, int skip) {
  rays->ox[j] = origin.x;
  rays->oy[j] = origin.y;
  rays->oz[j] = origin.z;
  rays->dx[j] = direction.x;
  rays->dy[j] = direction.y;
  rays->dz[j] = direction.z;
  rays->tmax[j] = tmax;
  rays->skip[j] = skip;
}

STAGE void load_rays(PRIVATE RayLanes* RESTRICT rays, const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      load_lane_ray(rays, j, get_ray_origin(paths, i + j), get_ray_direction(paths, i + j),
                    get_ray_tmax(paths, i + j), get_ray_skip(paths, i + j));
}

STAGE void gather_shadow_rays(PRIVATE RayLanes* RESTRICT rays, const PRIVATE PathState* paths,
                              const GLOBAL int* RESTRICT wanted) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int i = wanted[j];
      load_lane_ray(rays, j, get_shadow_origin(paths, i), get_shadow_direction(paths, i),
                    get_shadow_tmax(paths, i), get_shadow_skip(paths, i));
    }
}

STAGE void scatter_transmittances(const PRIVATE RayLanes* RESTRICT rays, const PRIVATE PathState* paths,
                                  const GLOBAL int* RESTRICT wanted) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      set_shadow_transmittance(paths, wanted[j], rays->hit[j] < 0 ? 1.0f : 0.0f);
}

/// Sets the transmittances; negative if the occluder may let light through.
STAGE void doubt_transmittances(const PRIVATE Scene* scene, const PRIVATE RayLanes* RESTRICT rays,
                                const PRIVATE PathState* paths, const GLOBAL int* RESTRICT wanted) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      set_shadow_transmittance(paths, wanted[j], share_behind(scene, rays->hit[j]));
}

STAGE void store_hits(const PRIVATE RayLanes* RESTRICT rays, const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) set_hit(paths, i + j, rays->hit[j]);
}

/// For lanes without rays.
FN void clear_hits(const PRIVATE PathState* paths, int i) {
  for (int j = i; j < i + LANES; j++) set_hit(paths, j, -1);
}

/// Tests every ray against every primitive.
FN void intersect_block_whole(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  if (NEEDS(scene, INSTANCES)) clear_hit_instances(paths, count);
  for (int i = 0; i < count; i += LANES) {
    if (!any_ray(paths, i)) {
      clear_hits(paths, i);
      continue;
    }
    RayLanes rays;
    load_rays(&rays, paths, i);
    intersect_brute_force(scene, &rays);
    store_hits(&rays, paths, i);
  }
}

/// The same for shadow rays.
FN void occlude_block_whole(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  GLOBAL int* RESTRICT wanted = paths->going;
  const int rays = list_shadow_rays(paths, count, wanted);
  for (int i = 0; i < rays; i += LANES) {
    RayLanes lanes;
    gather_shadow_rays(&lanes, paths, wanted + i);
    intersect_brute_force(scene, &lanes);
    scatter_transmittances(&lanes, paths, wanted + i);
    if (NEEDS_PASSING_LIGHT(scene)) doubt_transmittances(scene, &lanes, paths, wanted + i);
  }
}

FN int ray_hit(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i) {
  return intersect_bvh(scene, get_ray_origin(paths, i), get_ray_direction(paths, i), get_ray_tmax(paths, i),
                       get_ray_skip(paths, i))
      .primitive;
}

#if LANES > 1
STAGE void load_packet(const PRIVATE PathState* paths, int i, PRIVATE RayPacket* RESTRICT packet,
                       PRIVATE float* RESTRICT dx, PRIVATE float* RESTRICT dy, PRIVATE float* RESTRICT dz) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 o = get_ray_origin(paths, i + j), d = get_ray_direction(paths, i + j);
      packet->ox[j] = o.x;
      packet->oy[j] = o.y;
      packet->oz[j] = o.z;
      dx[j] = d.x;
      dy[j] = d.y;
      dz[j] = d.z;
      packet->t[j] = get_ray_tmax(paths, i + j);
      packet->skip[j] = get_ray_skip(paths, i + j);
    }
}

/// Intersects LANES camera rays from lane i on, as a packet if their directions allow it.
FN void intersect_together(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i) {
  RayPacket packet;
  float dx[LANES], dy[LANES], dz[LANES];
  load_packet(paths, i, &packet, dx, dy, dz);
  const BvhRay lead = make_bvh_ray(get_ray_origin(paths, i), get_ray_direction(paths, i), -1);
  const bool packed = prepare_packet(&packet, &lead, dx, dy, dz);
  if (packed) intersect_packet(scene, &packet, &lead, dx, dy, dz);
  for (int j = 0; j < LANES; j++)
    set_hit(paths, i + j, packed ? packet.hit[j] : ray_hit(scene, paths, i + j));
}
#endif

/// Traces rays through the BVH. `together`: neighbouring rays are coherent.
FN void intersect_block_bvh(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count,
                            bool together) {
  if (NEEDS(scene, INSTANCES) && !has_still_instances(scene)) clear_hit_instances(paths, count);
  if (has_still_instances(scene)) {
    for (int i = 0; i < count; i++) {
      const Hit hit = intersect_levels(scene, get_ray_origin(paths, i), get_ray_direction(paths, i),
                                       get_ray_tmax(paths, i), get_ray_skip(paths, i),
                                       get_ray_skip_instance(paths, i), true);
      set_hit(paths, i, hit.primitive);
      set_hit_instance(paths, i, hit.instance);
    }
    return;
  }
#if defined(RAYS_IN_FLIGHT)
  if (!together) {
    const int rays = list_rays(paths, count, paths->going);
    intersect_in_flight(scene, paths, paths->going, rays);
    return;
  }
#endif
  int i = 0;
#if LANES > 1
  for (; together && i + LANES <= count; i += LANES) intersect_together(scene, paths, i);
#endif
  for (; i < count; i++) set_hit(paths, i, ray_hit(scene, paths, i));
}

/// Any hit of the lane's shadow ray.
FN Hit shadow_ray_hit(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i) {
  const vec3 origin = get_shadow_origin(paths, i), direction = get_shadow_direction(paths, i);
  const float tmax = get_shadow_tmax(paths, i);
  const int skip = get_shadow_skip(paths, i);
  if (has_still_instances(scene))
    return occlude_levels(scene, origin, direction, tmax, skip, get_shadow_skip_instance(paths, i), true);
  return occlude_bvh(scene, origin, direction, tmax, skip);
}

/// Traces shadow rays through the BVH.
FN void occlude_block_bvh(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
#if defined(RAYS_IN_FLIGHT)
  if (!has_still_instances(scene)) {
    const int rays = list_shadow_rays(paths, count, paths->going);
    occlude_in_flight(scene, paths, paths->going, rays);
    return;
  }
#endif
  for (int i = 0; i < count; i++)
    set_transmittance_of_hit(scene, paths, i, shadow_ray_hit(scene, paths, i).primitive);
}

/// Finds the primitive that each lane's ray hits of what is still. `together`: neighbouring rays are
/// coherent.
STAGE void intersect_still(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count,
                           bool together) {
#ifdef EXTERNAL_TRACER
  if (scene->tracer.intersect) {
    scene->tracer.intersect(scene->tracer.context, paths, count);
    return;
  }
#endif
  if (NEEDS(scene, BVH)) intersect_block_bvh(scene, paths, count, together);
  if (!NEEDS(scene, BVH)) intersect_block_whole(scene, paths, count);
}

/// Finds the primitive that each lane's ray hits.
FN void intersect_block(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count,
                        bool together) {
  const bool moves = has_moving_surfaces(scene);
  if (HAS(MOTION) && moves) end_rays_at_moving(scene, paths, count);
  intersect_still(scene, paths, count, together);
  if (HAS(MOTION) && moves) take_moving_hits(scene, paths, count);
}

/// Intersectors that take one ray at a time skip the lanes from `count` on, which repeat the last path. This
/// copies its hit too.
FN void pad_hits(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  for (int i = count; i % LANES != 0; i++) set_hit(paths, i, get_hit(paths, count - 1));
  if (!NEEDS(scene, INSTANCES)) return;
  for (int i = count; i % LANES != 0; i++) set_hit_instance(paths, i, get_hit_instance(paths, count - 1));
}

/// Finds the transmittance of each lane's shadow ray past what is still; negative if the occluder may let
/// light through.
STAGE void occlude_by_still(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  if (HAS(DIRECT) && !scene->header.integrator.trace_shadows) {
    for (int i = 0; i < count; i++) set_shadow_transmittance(paths, i, 1.0f);
    return;
  }
#ifdef EXTERNAL_TRACER
  if (scene->tracer.occlude) {
    scene->tracer.occlude(scene->tracer.context, paths, count);
    if (NEEDS_PASSING_LIGHT(scene)) doubt_occluded(paths, count);
    return;
  }
#endif
  if (NEEDS(scene, BVH)) occlude_block_bvh(scene, paths, count);
  if (!NEEDS(scene, BVH)) occlude_block_whole(scene, paths, count);
}

/// The same past everything.
FN void occlude_block(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  occlude_by_still(scene, paths, count);
  const bool traces = !HAS(DIRECT) || scene->header.integrator.trace_shadows != 0;
  if (HAS(MOTION) && traces && has_moving_surfaces(scene)) occlude_by_moving(scene, paths, count);
}

/// The contribution of a lane's shadow ray, if `wanted`: its light times `share`.
FN vec3 shadow_ray_light(const PRIVATE PathState* paths, int i, bool wanted, float share) {
  const bool lit = wanted & (share > 0.0f) & (get_shadow_tmax(paths, i) > 0.0f);
  return select3(lit, scale(get_shadow_radiance(paths, i), share), make_vec3(0.0f, 0.0f, 0.0f));
}

/// Multiplies the transmittances by the fraction that bumps at the start of the shadow ray let through.
STAGE void shade_shadow_rays(const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++)
        set_shadow_transmittance(paths, j, get_shadow_transmittance(paths, j) * get_shadow_share(paths, j));
  }
}

/// Adds the light of unoccluded shadow rays to the radiance of their paths.
STAGE void add_light(const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const vec3 light = shadow_ray_light(paths, j, true, get_shadow_transmittance(paths, j));
        set_radiance(paths, j, add(get_radiance(paths, j), light));
      }
  }
}

/// The same for a path with control variates of polygon lights: their light goes into separate sums, with and
/// without shadows. `has_own_control`: the unshadowed sum gets `shadow_control` instead of the path's own
/// light. `coloured`: see NEEDS_PASSES.
FN void add_controlled(const PRIVATE PathState* paths, int i, bool has_own_control, bool coloured) {
  const int kind = get_shadow_controlled(paths, i);
  const bool controlled = kind != CONTROL_NONE;
  const float transmittance = get_shadow_transmittance(paths, i);
  const float seen = kind == CONTROL_BENEATH ? 0.0f : transmittance;
  vec3 other = shadow_ray_light(paths, i, !controlled, transmittance);
  vec3 unshadowed = shadow_ray_light(paths, i, controlled, 1.0f);
  if (HAS(LTC) && has_own_control) {
    const bool lit = controlled & (get_shadow_tmax(paths, i) > 0.0f);
    unshadowed = select3(lit, get_shadow_control(paths, i), make_vec3(0.0f, 0.0f, 0.0f));
  }
  vec3 shadowed = shadow_ray_light(paths, i, controlled, seen);
  if ((HAS(MEDIA) || HAS(PANES) || HAS(FLAT_GLASS)) && coloured) {
    other = mul(other, get_shadow_passes(paths, i));
    shadowed = mul(shadowed, get_shadow_passes(paths, i));
  }
  set_radiance(paths, i, add(get_radiance(paths, i), other));
  set_unshadowed(paths, i, add(get_unshadowed(paths, i), unshadowed));
  set_shadowed(paths, i, add(get_shadowed(paths, i), shadowed));
}

// For all lanes.
#define ADD_CONTROLLED_LIGHT(stage, has_own_control, coloured)                                   \
  STAGE void stage(const PRIVATE PathState* paths, int count) {                                  \
    for (int i = 0; i < count; i += LANES) {                                                     \
      LANE_LOOP                                                                                  \
        for (int j = i; j < i + LANES; j++) add_controlled(paths, j, has_own_control, coloured); \
    }                                                                                            \
  }
ADD_CONTROLLED_LIGHT(add_controlled_light, false, false)
ADD_CONTROLLED_LIGHT(add_controlled_light_by_form, true, false)
ADD_CONTROLLED_LIGHT(add_controlled_coloured_light, false, true)
ADD_CONTROLLED_LIGHT(add_controlled_coloured_light_by_form, true, true)
#undef ADD_CONTROLLED_LIGHT

/// Calls the variant that the scene needs.
FN void add_light_with_control(const PRIVATE Scene* scene, bool has_own_control,
                               const PRIVATE PathState* paths, int count) {
  if (NEEDS_PASSES(scene)) {
    if (HAS(LTC) && has_own_control) add_controlled_coloured_light_by_form(paths, count);
    if (!has_own_control) add_controlled_coloured_light(paths, count);
    return;
  }
  if (HAS(LTC) && has_own_control) add_controlled_light_by_form(paths, count);
  if (!has_own_control) add_controlled_light(paths, count);
}

PENUMBRA_NAMESPACE_END
#endif
