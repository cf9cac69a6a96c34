// Flights through media that vary from place to place: tentative collisions by a majorant, of which some are
// null (delta tracking, Woodcock et al. 1965), and what gets through by what every one of them lets pass
// (ratio tracking, Novak, Selle and Jarosz 2014). Null collisions are vertices of the path that both ways of
// finding a light have in common, so their densities compare (Miller, Georgiev and Jarosz 2019), and paths
// keep the ratios of their channels' as in flight.h.
#ifndef PENUMBRA_TRACKING_H
#define PENUMBRA_TRACKING_H
#include "kernels/medium/flight.h"
#include "kernels/medium/volume.h"

PENUMBRA_NAMESPACE_BEGIN

// What gets through less is nothing: products of shares do not become 0, but stay the smallest number.
#define LEAST_PASSING 1e-37f
// Beyond so many null collisions a ray ends, and its sample is not finite, so that it is counted.
#define MOST_NULL_COLLISIONS 67108864

FN bool is_grid(GLOBAL const Medium* medium) { return medium->density >= 0; }

/// The share of real collisions, of all that there are by the majorant, by channel.
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

/// What a flight has become.
typedef struct {
  FlightWeight weight;
  float left;   ///< optical depth before the next collision
  float reach;  ///< how far from its start it scatters; negative: it does not
} TrackedFlight;

/// A flight of at most `length` from the origin through a medium with a grid, which `hero` decides.
FN TrackedFlight track_flight(const PRIVATE Scene* scene, GLOBAL const Medium* medium, vec3 origin,
                              vec3 direction, float length, int hero, FlightWeight weight, float left,
                              uint random) {
  GLOBAL const Volume* v = scene->volumes + medium->density;
  const vec3 extinction = load3(&medium->extinction);
  const float strongest = max_component(extinction);
  VolumeWalk walk = start_walk(v, origin, direction, length, left, random);
  TrackedFlight flight;
  flight.weight = weight;
  flight.reach = -1.0f;
  for (int k = 0; next_collision(scene, v, strongest, &walk); k++) {
    const vec3 share = real_share(scene, v, extinction, &walk), other = one_minus3(share);
    const bool real = next_number(&walk) < channel_of(share, hero);
    if (real) {
      flight.weight = weigh_flight(flight.weight, mul(load3(&medium->albedo), share), share);
      flight.reach = walk.t;
      break;
    }
    flight.weight = weigh_flight(flight.weight, other, other);
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

/// What gets through a medium with a grid over `length` from the origin, without bias.
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
