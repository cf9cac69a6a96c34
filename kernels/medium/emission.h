// Emission of media: the radiance that a ray collects on its way, the integral of transmittance times
// emission (radiance per scene unit). It does not depend on where the path scatters, so it is added for each
// whole flight up to the next surface, and causes the path's next event no noise.
//
// Without grids the integral has a closed form; where it is weighed against samples of a light, it is
// estimated at EVEN_POINTS points, half of them by the weights and half by the transmittance. With grids it
// is estimated at points of two kinds, with weights by the balance heuristic (Veach and Guibas 1995):
// EMISSION_POINTS points, evenly spaced in the integral of the emission's majorants along the ray, which find
// a small flame in a large grid; and the tentative collisions of ratio tracking, which find what is in front
// in a dense medium.
#ifndef PENUMBRA_MEDIUM_EMISSION_H
#define PENUMBRA_MEDIUM_EMISSION_H
#include "kernels/light/mis.h"
#include "kernels/medium/tracking.h"

PENUMBRA_NAMESPACE_BEGIN

#define EMISSION_POINTS 8.0f  // at most MOST_PIECE_DEPTH, so that rays are not divided into pieces

FN bool emits_light(GLOBAL const Medium* medium) { return max_component(load3(&medium->emission)) > 0.0f; }

FN bool emits_evenly(GLOBAL const Medium* medium) {
  return (medium->emission_grid < 0) & (medium->emission_by_density == 0);
}

/// The integral of the transmittance over `length`: at most that.
FN float passing_length(float extinction, float length) {
  const float depth = extinction * length;
  // The series up to depth^3 / 24 < 1e-13; a product that underflows is 0.
  const float thin = length * (1.0f - depth * (0.5f - depth * (1.0f / 6.0f)));
  const float thick = -expm1_f(-min_f(depth, 80.0f)) / max_f(extinction, 1e-37f);
  return depth < 1e-4f ? thin : thick;
}

/// What a ray collects over `length` of a medium with the same extinction and emission everywhere.
FN vec3 even_emission(vec3 extinction, vec3 emission, float length) {
  return mul(emission, make_vec3(passing_length(extinction.x, length), passing_length(extinction.y, length),
                                 passing_length(extinction.z, length)));
}

FN bool is_in_cells(GLOBAL const Volume* v, vec3 place) {
  return (place.x >= 0.0f) & (place.y >= 0.0f) & (place.z >= 0.0f) & (place.x <= (float)v->nx) &
         (place.y <= (float)v->ny) & (place.z <= (float)v->nz);
}

/// The volume's value at a point of the scene, 0 outside of its box.
FN vec3 value_within(const PRIVATE Scene* scene, GLOBAL const Volume* v, vec3 p) {
  const vec3 place = volume_place(v, p);
  return is_in_cells(v, place) ? volume_value(scene, v, place) : make_vec3(0.0f, 0.0f, 0.0f);
}

/// The maximum of the numbers near a point of the scene, 0 outside of the box.
FN float majorant_within(const PRIVATE Scene* scene, GLOBAL const Volume* v, vec3 p) {
  const vec3 place = volume_place(v, p);
  const int x = coarse_cell(place.x, v->nx), y = coarse_cell(place.y, v->ny), z = coarse_cell(place.z, v->nz);
  const int index = v->first_majorant + (z * majorant_cells(v->ny) + y) * majorant_cells(v->nx) + x;
  return is_in_cells(v, place) ? scene->majorants[index] : 0.0f;
}

/// The emission of a medium with grids, in radiance per scene unit.
FN vec3 emission_at(const PRIVATE Scene* scene, GLOBAL const Medium* medium, vec3 p) {
  vec3 emission = load3(&medium->emission);
  if (medium->emission_grid >= 0)
    emission = mul(emission, value_within(scene, scene->volumes + medium->emission_grid, p));
  if (medium->emission_by_density != 0)
    emission = mul(emission, value_within(scene, scene->volumes + medium->density, p));
  return emission;
}

FN vec3 extinction_at(const PRIVATE Scene* scene, GLOBAL const Medium* medium, vec3 p) {
  const vec3 extinction = load3(&medium->extinction);
  return is_grid(medium) ? mul(extinction, value_within(scene, scene->volumes + medium->density, p))
                         : extinction;
}

/// How a ray is dimmed on its way.
typedef struct {
  VolumeWalk walk;  ///< through the density; without a grid only `t`, `left`, `majorant` and `random` count
  float end;        ///< of the walk
  vec3 kept;        ///< transmittance of a grid by ratio tracking, over the probability that the ray goes on
} DimmedRay;

FN DimmedRay start_dimming(const PRIVATE Scene* scene, GLOBAL const Medium* medium, vec3 origin,
                           vec3 direction, float length, uint random) {
  DimmedRay ray;
  GLOBAL const Volume* v = scene->volumes + (is_grid(medium) ? medium->density : medium->emission_grid);
  ray.walk = start_walk(v, origin, direction, length, 0.0f, random);
  if (!is_grid(medium)) ray.walk.t = 0.0f;
  ray.end = ray.walk.end;
  ray.kept = make_vec3(1.0f, 1.0f, 1.0f);
  const float u = next_number(&ray.walk);
  ray.walk.left = flight_depth(u, next_number(&ray.walk));
  return ray;
}

/// Advances to the next tentative collision before the distance `until`, or returns false.
FN bool next_dimming(const PRIVATE Scene* scene, GLOBAL const Medium* medium, float until,
                     PRIVATE DimmedRay* ray) {
  const float strongest = max_component(load3(&medium->extinction));
  if (!(strongest > 0.0f)) return false;
  if (is_grid(medium)) {
    ray->walk.end = min_f(until, ray->end);
    return next_collision(scene, scene->volumes + medium->density, strongest, &ray->walk);
  }
  const float depth = (until - ray->walk.t) * strongest;
  const bool collides = ray->walk.left < depth;
  ray->walk.majorant = strongest;
  ray->walk.t = collides ? ray->walk.t + ray->walk.left / strongest : until;
  ray->walk.left -= depth;
  return collides;
}

/// The fractions of tentative collisions that are real at the last one.
FN vec3 dimming_share(const PRIVATE Scene* scene, GLOBAL const Medium* medium, const PRIVATE DimmedRay* ray) {
  const vec3 extinction = load3(&medium->extinction);
  if (is_grid(medium)) return real_share(scene, scene->volumes + medium->density, extinction, &ray->walk);
  return scale(extinction, 1.0f / ray->walk.majorant);
}

/// An unbiased estimate of the transmittance up to the distance `t` that the ray has reached.
FN vec3 passed_to(GLOBAL const Medium* medium, const PRIVATE DimmedRay* ray, float t) {
  return is_grid(medium) ? ray->kept : mul(ray->kept, exp3(scale(load3(&medium->extinction), -t)));
}

/// What weighs against samples of a light that the medium is, see light/medium_light.h.
typedef struct {
  float direction;  ///< pdf of the ray's direction at its start
  float light;      ///< pdf of the light's samples at distance 1; 0: there are none
  float way;        ///< distance from the ray's start to the origin
  int heuristic;    ///< HEURISTIC_*
} EmissionBalance;

/// There are no samples to weigh against.
FN EmissionBalance no_balance(void) {
  EmissionBalance balance;
  balance.direction = 1.0f;
  balance.light = balance.way = 0.0f;
  balance.heuristic = HEURISTIC_BALANCE;
  return balance;
}

/// The weight of what a ray finds at the distance `t` from the origin.
FN float emission_weight(EmissionBalance balance, float t) {
  return mis_weight(balance.heuristic, balance.direction, balance.light * sqr(balance.way + t));
}

#define EVEN_POINTS 4

/// What a ray collects over `length` from the origin in a medium with the same emission everywhere, times the
/// weights: an unbiased estimate.
FN vec3 weighed_even_emission(GLOBAL const Medium* medium, float length, EmissionBalance balance,
                              uint random) {
  const vec3 extinction = load3(&medium->extinction);
  const float strongest = max_component(extinction), depth = strongest * length;
  // The balance heuristic's weight is 1 / (1 + x^2) at x = root (way + t). It is sampled by its integral,
  // whose values are angles.
  const float root = SQRT(balance.light / balance.direction), start = root * balance.way;
  const float reach = root * length, around = 1.0f + start * start;
  const float angle = atan2_f(reach, around + start * reach);
  const bool weighs = angle > 1e-12f, dims = depth > 1e-4f;
  const float opaque = -expm1_f(-min_f(depth, 80.0f));
  vec3 sum = make_vec3(0.0f, 0.0f, 0.0f);
  for (int k = 0; k < EVEN_POINTS; k++) {
    random = hash_uint(random + 0x9e3779b9u);
    const float u = ((float)(k >> 1) + unit_float(random)) * (2.0f / (float)EVEN_POINTS);
    float sine, cosine;
    sincos_2pi(u * angle * (0.5f / PI_F), &sine, &cosine);
    const float by_weight = sine * around / max_f(root * (cosine - start * sine), 1e-30f);
    const float by_passing = dims ? -log1p_f(-u * opaque) / strongest : u * length;
    const bool by_weights = weighs & ((k & 1) != 0);
    const float t = min_f(by_weights ? by_weight : by_passing, length);
    const float pdf_of_weight = root / (max_f(angle, 1e-12f) * (1.0f + sqr(start + root * t)));
    const float pdf_of_passing = dims ? strongest * exp_f(-strongest * t) / opaque : 1.0f / length;
    const float pdf = weighs ? 0.5f * (pdf_of_weight + pdf_of_passing) : pdf_of_passing;
    sum = add_scaled(sum, emission_weight(balance, t) / (pdf * (float)EVEN_POINTS),
                     exp3(scale(extinction, -t)));
  }
  return mul(sum, load3(&medium->emission));
}

/// What a ray collects over `length` from the origin in a medium whose emission varies, times the weights: an
/// unbiased estimate.
FN vec3 track_emission(const PRIVATE Scene* scene, GLOBAL const Medium* medium, vec3 origin, vec3 direction,
                       float length, EmissionBalance balance, uint random) {
  GLOBAL const Volume* v =
      scene->volumes + (medium->emission_grid >= 0 ? medium->emission_grid : medium->density);
  vec3 sum = make_vec3(0.0f, 0.0f, 0.0f);
  VolumeWalk points = start_walk(v, origin, direction, length, 0.0f, random);
  const float whole = majorant_integral(scene, v, points);
  if (!(whole > 1e-30f)) return sum;
  const float rate = EMISSION_POINTS / whole;
  points.left = next_number(&points);
  DimmedRay ray = start_dimming(scene, medium, origin, direction, length, hash_uint(random ^ 0x2545f491u));
  int collisions = 0, found = 0;
  for (bool more = true; more;) {
    // Where the ray only grazes the grid, floats cannot distinguish the points, and no number of them ends
    // it.
    more = found++ < (int)EMISSION_POINTS && next_collision(scene, v, rate, &points);
    while (next_dimming(scene, medium, more ? points.t : points.end, &ray)) {
      const vec3 p = add_scaled(origin, ray.walk.t, direction);
      const vec3 share = dimming_share(scene, medium, &ray), passed = passed_to(medium, &ray, ray.walk.t);
      const float real = max_component(share);
      const float both = rate * majorant_within(scene, v, p) + real * ray.walk.majorant;
      const float weight = emission_weight(balance, ray.walk.t);
      if (real > 0.0f)
        sum = add(sum, scale(mul(passed, emission_at(scene, medium, p)), weight * (real / both)));
      if (is_grid(medium)) ray.kept = mul(ray.kept, one_minus3(share));
      const bool by_chance = max_component(passed) < LEAST_SURE_PASSING;
      if (by_chance && next_number(&ray.walk) < 0.5f) return sum;
      ray.kept = scale(ray.kept, by_chance ? 2.0f : 1.0f);
      if (!(max_component(ray.kept) > LEAST_PASSING)) return sum;
      if (++collisions > MOST_NULL_COLLISIONS) return no_numbers();
      const float u = next_number(&ray.walk);
      ray.walk.left = flight_depth(u, next_number(&ray.walk));
    }
    if (!more) break;
    const vec3 p = add_scaled(origin, points.t, direction);
    const float both = points.majorant + max_component(extinction_at(scene, medium, p));
    const float weight = emission_weight(balance, points.t);
    sum =
        add(sum, scale(mul(passed_to(medium, &ray, points.t), emission_at(scene, medium, p)), weight / both));
    points.left = 1.0f;
  }
  return sum;
}

PENUMBRA_NAMESPACE_END
#endif
