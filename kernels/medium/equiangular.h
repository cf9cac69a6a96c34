// Equiangular sampling of distances along a ray in a medium, about a light cluster: distances are distributed
// uniformly in the angle as seen from the cluster (Kulla and Fajardo 2012), so that the inverse square law
// causes no noise. It is combined with sampling by the medium's extinction by the balance heuristic.
#ifndef PENUMBRA_EQUIANGULAR_H
#define PENUMBRA_EQUIANGULAR_H
#include "kernels/math/math.h"
#include "kernels/math/vec3.h"
#include "kernels/medium/flight.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

// A part of a ray as seen from a place. `along`: the distance along the ray's line from the start to the
// point nearest to the place; `away`: the distance of that point from the place, above 0; `square`: the
// squared distance from the start to the place; `angle`: the angle that the part subtends.
#define EQUIANGULAR_FIELDS(F, a) \
  F(a, float, along)             \
  F(a, float, away)              \
  F(a, float, square)            \
  F(a, float, angle)
LANE_RECORD(EquiangularSegment, EquiangularSegments, equiangular, EQUIANGULAR_FIELDS)

/// The first `length` of the ray, as seen from a place of that size. If the place is on the ray's origin, the
/// angle is 0 and there is no sampling.
FN EquiangularSegment equiangular_segment(vec3 origin, vec3 direction, float length, vec3 place, float size) {
  const vec3 to = sub(place, origin);
  const float along = dot3(to, direction), apart = length3(cross3(direction, to));
  EquiangularSegment segment;
  segment.along = along;
  segment.away = max_f(apart, max_f(size, 1e-4f * FABS(along)));
  segment.square = segment.away * segment.away + along * along;
  // Computed from the tangents of both ends, so that small angles are accurate, too.
  segment.angle = atan2_f(segment.away, segment.square / max_f(length, 1e-30f) - along);
  return segment;
}

/// The distance from the start at the fraction u of the angle.
FN float equiangular_distance(EquiangularSegment s, float u) {
  float sine, cosine;
  sincos_2pi(u * s.angle * (0.5f / PI_F), &sine, &cosine);
  const float below = s.away * cosine + s.along * sine;
  return s.square * sine / max_f(below, 1e-30f);
}

/// Pdf of those distances, per scene unit.
FN float equiangular_pdf(EquiangularSegment s, float distance) {
  const float beyond = distance - s.along;
  return s.away / (s.angle * (s.away * s.away + beyond * beyond));
}

// Smaller shares are not worth the cost.
#define LEAST_EQUIANGULAR_SHARE 0.05f

/// The fraction of scattering flights that are sampled equiangularly, for one channel. It is nearly all if
/// the place and the ray's nearest point are close, in mean free paths, so that the light falls off faster
/// than the transmittance.
FN float equiangular_share(EquiangularSegment s, float length, float extinction) {
  const float at = clamp_f(s.along, 0.0f, length);
  const float share = 0.9f / (1.0f + extinction * extinction * (s.away * s.away + at * at));
  return share < LEAST_EQUIANGULAR_SHARE ? 0.0f : share;
}
FN vec3 equiangular_shares(EquiangularSegment s, float length, vec3 extinction) {
  return make_vec3(equiangular_share(s, length, extinction.x), equiangular_share(s, length, extinction.y),
                   equiangular_share(s, length, extinction.z));
}

FN float equiangular_density(float extinction, float more, float share, float length, float equiangular,
                             float distance) {
  const float by_medium = extinction * exp_f(-more * distance);
  return by_medium + share * (equiangular * -expm1_f(-extinction * length) - by_medium);
}

/// The weight of a path that scatters at `distance` in a part of a ray with that length, sampled
/// equiangularly or by the medium.
FN FlightWeight weigh_equiangular(FlightWeight before, vec3 extinction, vec3 albedo,
                                  EquiangularSegment segment, vec3 share, float length, float distance) {
  const float least = min_f(min_f(extinction.x, extinction.y), extinction.z);
  const vec3 more = sub(extinction, make_vec3(least, least, least));
  const vec3 collides = mul(extinction, exp3(scale(more, -distance)));
  // All quantities are ratios to the transmittance of the least extinct channel. At a ratio of 1e26 (the
  // clamp) the rest is negligible.
  const float equiangular = equiangular_pdf(segment, distance) * exp_f(min_f(least * distance, 60.0f));
  vec3 densities;
  densities.x = equiangular_density(extinction.x, more.x, share.x, length, equiangular, distance);
  densities.y = equiangular_density(extinction.y, more.y, share.y, length, equiangular, distance);
  densities.z = equiangular_density(extinction.z, more.z, share.z, length, equiangular, distance);
  return weigh_flight(before, mul(albedo, collides), densities);
}

PENUMBRA_NAMESPACE_END
#endif
