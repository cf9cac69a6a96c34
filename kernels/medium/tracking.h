// Flights through heterogeneous media. Distances are sampled by delta tracking: tentative collisions by a
// majorant, some of which are null (Woodcock et al. 1965). Transmittance is estimated by ratio tracking
// (Novak, Selle and Jarosz 2014). Null collisions are path vertices that BSDF or phase function sampling and
// next-event estimation have in common, so that their densities can be compared (Miller, Georgiev and Jarosz
// 2019). Paths store the ratios of their channels' densities as in flight.h.
#ifndef PENUMBRA_TRACKING_H
#define PENUMBRA_TRACKING_H
#include "kernels/medium/flight.h"
#include "kernels/medium/volume.h"

PENUMBRA_NAMESPACE_BEGIN

// Lower transmittance counts as 0. Products of shares do not reach 0, but stop at the smallest float.
#define LEAST_PASSING 1e-37f
// Rays of which less is left go on by chance.
#define LEAST_SURE_PASSING 0.125f
// After so many null collisions a ray ends. Its sample becomes non-finite, so that it is counted.
#define MOST_NULL_COLLISIONS 67108864

FN bool is_grid(GLOBAL const Medium* medium) { return medium->density >= 0; }

/// The fraction of tentative collisions that are real, by channel.
FN vec3 real_share(const PRIVATE Scene* scene, GLOBAL const Volume* v, vec3 extinction,
                   const PRIVATE VolumeWalk* walk) {
  const vec3 sigma = mul(extinction, volume_value(scene, v, walk_place(walk)));
  const vec3 share = scale(sigma, 1.0f / walk->majorant);
  return make_vec3(min_f(share.x, 1.0f), min_f(share.y, 1.0f), min_f(share.z, 1.0f));
}

FN vec3 no_numbers(void) {
  const float nan = BITS_FLOAT(0x7fc00000u);
  return make_vec3(nan, nan, nan);
}

FN vec3 one_minus3(vec3 v) { return make_vec3(1.0f - v.x, 1.0f - v.y, 1.0f - v.z); }

/// The result of a flight.
typedef struct {
  FlightWeight weight;
  float left;   ///< optical depth left until the next collision
  float reach;  ///< distance from the start to where it scatters; negative: it does not
} TrackedFlight;

/// A flight of at most `length` from the origin through a heterogeneous medium. Channel `hero` samples it. In
/// a medium that only absorbs, all collisions are null, as in track_passing.
FN TrackedFlight track_flight(const PRIVATE Scene* scene, GLOBAL const Medium* medium, vec3 origin,
                              vec3 direction, float length, int hero, FlightWeight weight, float left,
                              uint random) {
  GLOBAL const Volume* v = scene->volumes + medium->density;
  const vec3 extinction = load3(&medium->extinction);
  const float strongest = max_component(extinction);
  const bool absorbs = only_absorbs(load3(&medium->albedo));
  vec3 kept = make_vec3(1.0f, 1.0f, 1.0f);
  VolumeWalk walk = start_walk(v, origin, direction, length, left, random);
  TrackedFlight flight;
  flight.weight = weight;
  flight.reach = -1.0f;
  for (int k = 0; next_collision(scene, v, strongest, &walk); k++) {
    const vec3 share = real_share(scene, v, extinction, &walk), other = one_minus3(share);
    const bool real = !absorbs && next_number(&walk) < channel_of(share, hero);
    if (real) {
      flight.weight = weigh_flight(flight.weight, mul(load3(&medium->albedo), share), share);
      flight.reach = walk.t;
      break;
    }
    flight.weight = weigh_flight(flight.weight, other, select3(absorbs, make_vec3(1.0f, 1.0f, 1.0f), other));
    if (absorbs) {
      kept = mul(kept, other);
      const bool by_chance = max_component(kept) < LEAST_SURE_PASSING;
      const float factor = !by_chance ? 1.0f : next_number(&walk) < 0.5f ? 2.0f : 0.0f;
      kept = scale(kept, factor);
      flight.weight.throughput = scale(flight.weight.throughput, factor);
      if (!(max_component(kept) > LEAST_PASSING)) {
        flight.weight.throughput = make_vec3(0.0f, 0.0f, 0.0f);
        flight.reach = walk.t;  // the path ends there
        break;
      }
    }
    const float u = next_number(&walk);
    walk.left = flight_depth(u, next_number(&walk));
    if (k >= MOST_NULL_COLLISIONS) {
      flight.weight.throughput = no_numbers();
      walk.left = NO_LIMIT;
    }
  }
  flight.left = walk.left;
  return flight;
}

/// An unbiased estimate of a heterogeneous medium's transmittance over `length` from the origin.
FN vec3 track_passing(const PRIVATE Scene* scene, GLOBAL const Medium* medium, vec3 origin, vec3 direction,
                      float length, uint random) {
  GLOBAL const Volume* v = scene->volumes + medium->density;
  const vec3 extinction = load3(&medium->extinction);
  const float strongest = max_component(extinction);
  VolumeWalk walk = start_walk(v, origin, direction, length, 0.0f, random);
  vec3 passes = make_vec3(1.0f, 1.0f, 1.0f);
  for (int k = 0; k < MOST_NULL_COLLISIONS && max_component(passes) > LEAST_PASSING; k++) {
    const float u = next_number(&walk);
    walk.left = flight_depth(u, next_number(&walk));
    if (!next_collision(scene, v, strongest, &walk)) return passes;
    passes = mul(passes, one_minus3(real_share(scene, v, extinction, &walk)));
  }
  return max_component(passes) > LEAST_PASSING ? no_numbers() : make_vec3(0.0f, 0.0f, 0.0f);
}

PENUMBRA_NAMESPACE_END
#endif
