// Shadow rays that pass through surfaces: finds the fraction of light that gets through. block_see_through.h
// does this for the other rays.
#ifndef PENUMBRA_BLOCK_SEE_LIGHTS_H
#define PENUMBRA_BLOCK_SEE_LIGHTS_H
#include "kernels/block/block_see_through.h"
#include "kernels/integrator/flat_glass.h"

PENUMBRA_NAMESPACE_BEGIN

/// Saves the paths' rays and replaces them by their shadow rays. Only those whose occluder may let light
/// through are followed. Returns whether there are any.
STAGE bool follow_shadow_rays(const PRIVATE PathState* paths, int count) {
  int any = 0;
  const PathState fields = *paths;
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const float share = get_shadow_transmittance(&fields, j), tmax = get_shadow_tmax(&fields, j);
        const bool follows = (j < count) & (tmax > 0.0f) & (share < 0.0f);
        set_kept_origin(&fields, j, get_ray_origin(&fields, j));
        set_kept_direction(&fields, j, get_ray_direction(&fields, j));
        set_kept_tmax(&fields, j, get_ray_tmax(&fields, j));
        set_kept_skip(&fields, j, get_ray_skip(&fields, j));
        set_kept_hit(&fields, j, get_hit(&fields, j));
        set_ray_origin(&fields, j, get_shadow_origin(&fields, j));
        set_ray_direction(&fields, j, get_shadow_direction(&fields, j));
        set_ray_skip(&fields, j, get_shadow_skip(&fields, j));
        set_ray_tmax(&fields, j, follows ? tmax : -1.0f);
        set_shadow_transmittance(&fields, j, follows ? 1.0f : share);
        any |= follows ? 1 : 0;
      }
  }
  return any != 0;
}

/// Restores the paths' rays. Shadow rays that passed too many surfaces are occluded.
STAGE void leave_shadow_rays(const PRIVATE PathState* paths, int count) {
  const PathState fields = *paths;
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const float share = get_shadow_transmittance(&fields, j);
        set_shadow_transmittance(&fields, j, get_ray_tmax(&fields, j) > 0.0f ? 0.0f : share);
        set_ray_origin(&fields, j, get_kept_origin(&fields, j));
        set_ray_direction(&fields, j, get_kept_direction(&fields, j));
        set_ray_tmax(&fields, j, get_kept_tmax(&fields, j));
        set_ray_skip(&fields, j, get_kept_skip(&fields, j));
        set_hit(&fields, j, get_kept_hit(&fields, j));
      }
  }
}

/// Multiplies the transmittances of shadow rays by the `shares` that pass these surfaces. Sets which rays go
/// on.
STAGE void dim_shadow_rays(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces,
                           const PRIVATE float* RESTRICT shares, PRIVATE int* RESTRICT passes) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const float before = get_shadow_transmittance(paths, i + j);
      const bool hit = (get_ray_tmax(paths, i + j) > 0.0f) & (surfaces->primitive[j] >= 0);
      const float after = hit ? before * shares[j] : before;
      set_shadow_transmittance(paths, i + j, after);
      passes[j] = (hit & (after > 0.0f)) ? 1 : 0;
    }
}

/// Multiplies the tints of shadow rays by the mean tint of the light that passes.
STAGE void tint_shadow_rays(const PRIVATE PathState* paths, int i, const PRIVATE float* RESTRICT shares,
                            const PRIVATE PaneTints* RESTRICT light) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 before = get_shadow_tint(&fields, i + j), colour = load_pane_tint(light, j).colour;
      const float share = shares[j];
      const bool through = (get_ray_tmax(&fields, i + j) > 0.0f) & (share > 0.0f);
      const float of = through ? share : 1.0f;
      // What has no colour divides to exactly 1, as if nothing were tinted.
      const vec3 mean = make_vec3(colour.x / of, colour.y / of, colour.z / of);
      const vec3 tint = select3(through, mean, make_vec3(1.0f, 1.0f, 1.0f));
      set_shadow_tint(&fields, i + j, mul(before, tint));
    }
}

/// Nothing has tinted the shadow rays yet. `passes`: nothing else sets `shadow_passes`.
STAGE void start_tints(const PRIVATE PathState* paths, int count, bool passes) {
  const vec3 one = make_vec3(1.0f, 1.0f, 1.0f);
  const PathState fields = *paths;
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        set_shadow_tint(&fields, j, one);
        if (passes) set_shadow_passes(&fields, j, one);
      }
  }
}

/// Multiplies what passes by the tint.
STAGE void apply_tints(const PRIVATE PathState* paths, int count) {
  const PathState fields = *paths;
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++)
        set_shadow_passes(&fields, j, mul(get_shadow_passes(&fields, j), get_shadow_tint(&fields, j)));
  }
}

/// Multiplies the light of shadow rays by what passes. It is not used with control variates, whose unshadowed
/// light must not change.
STAGE void dim_shadow_light(const PRIVATE PathState* paths, int count) {
  const PathState fields = *paths;
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++)
        set_shadow_radiance(&fields, j, mul(get_shadow_radiance(&fields, j), get_shadow_passes(&fields, j)));
  }
}

FN bool pass_light(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i) {
  Surfaces surfaces;
  PaneTints light;
  float shares[LANES];
  int passes[LANES];
  find_hit_surfaces(scene, paths, i, &surfaces);
  if (NEEDS(scene, NESTED)) passing_light(scene, &surfaces, shares, &light);
  if (!NEEDS(scene, NESTED)) start_passing(shares, &light);
  float lengths[LANES];
  if (NEEDS(scene, FLAT_GLASS)) pass_glass(scene, paths, i, &surfaces, shares, &light);
  if (NEEDS_TINTS(scene)) tint_shadow_rays(paths, i, shares, &light);
  if (NEEDS_MEDIA(scene)) dim_flights(scene, paths, i, &surfaces, lengths);
  dim_shadow_rays(paths, i, &surfaces, shares, passes);
  if (NEEDS_MEDIA(scene)) follow_boundaries(scene, paths, i, lengths, passes, true, &surfaces);
  if (NEEDS(scene, INSTANCES)) restart_behind_instances(paths, i, &surfaces, passes);
  return restart_behind(paths, i, &surfaces, passes);
}

/// After occlude_block: traces shadow rays on through the surfaces that stopped them.
CALLED_FN void see_lights_through(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  if (NEEDS(scene, INSTANCES)) follow_from_instances(paths, count);
  int most = MOST_PASSED;
  if (NEEDS_MEDIA(scene)) {
    most = MOST_CROSSED;
    start_shadow_flights(paths, count);
    dim_unobstructed(scene, paths, count);
  }
  if (NEEDS_TINTS(scene)) start_tints(paths, count, !NEEDS_MEDIA(scene));
  bool any = follow_shadow_rays(paths, count);
  for (int k = 0; any && k < most; k++) {
    intersect_block(scene, paths, count, false);
    pad_hits(scene, paths, count);
    any = false;
    for (int i = 0; i < count; i += LANES)
      if (any_ray(paths, i)) any = pass_light(scene, paths, i) | any;
  }
  if (NEEDS(scene, INSTANCES)) leave_for_instances(paths, count);
  leave_shadow_rays(paths, count);
  if (NEEDS_MEDIA(scene)) weigh_shadow_rays(scene, paths, count);
  if (NEEDS_GLOWS(scene)) end_in_glows(paths, count);
  if (NEEDS_TINTS(scene)) apply_tints(paths, count);
  if (NEEDS_PASSES(scene) && !has_control(scene)) dim_shadow_light(paths, count);
}

PENUMBRA_NAMESPACE_END
#endif
