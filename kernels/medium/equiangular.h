// Where a ray through a medium meets the light of a place: distances that share the angle evenly that the ray
// takes as seen from there (Kulla and Fajardo 2012), so that the light's falling with the square of the
// distance is no noise. Shared with what the medium's extinction says by the balance heuristic.
#ifndef PENUMBRA_EQUIANGULAR_H
#define PENUMBRA_EQUIANGULAR_H
#include "kernels/math/math.h"
#include "kernels/math/vec3.h"
#include "kernels/medium/flight.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

// A part of a ray as seen from a place: where it is nearest, from its start, on its line; how far it is
// from the place there, above 0; the square of the distance from its start to the place; the angle that it
// takes.
#define EQUIANGULAR_FIELDS(F, a) \
  F(a, float, along)             \
  F(a, float, away)              \
  F(a, float, square)            \
  F(a, float, angle)
LANE_RECORD(EquiangularSegment, EquiangularSegments, equiangular, EQUIANGULAR_FIELDS)

/// Of a ray's `length` from the origin, from a place of that size. Where they coincide there is none: its
/// angle is 0.
FN EquiangularSegment equiangular_segment(vec3 origin, vec3 direction, float length, vec3 place, float size) {
  const vec3 to = sub(place, origin);
  const float along = dot3(to, direction), apart = length3(cross3(direction, to));
  EquiangularSegment segment;
  segment.along = along;
  segment.away = max_f(apart, max_f(size, 1e-4f * FABS(along)));
  segment.square = segment.away * segment.away + along * along;
  // Of the tangents of both ends, so that a small one is as exact.
  segment.angle = atan2_f(segment.away, segment.square / max_f(length, 1e-30f) - along);
  return segment;
}

/// The distance from the start at a share u of the angle.
FN float equiangular_distance(EquiangularSegment s, float u) {
  float sine, cosine;
  sincos_2pi(u * s.angle * (0.5f / PI_F), &sine, &cosine);
  const float below = s.away * cosine + s.along * sine;
  return s.square * sine / max_f(below, 1e-30f);
}

/// Density of those distances, in 1 / scene unit.
FN float equiangular_pdf(EquiangularSegment s, float distance) {
  const float beyond = distance - s.along;
  return s.away / (s.angle * (s.away * s.away + beyond * beyond));
}

// Of shares that are less, nothing is gained.
#define LEAST_SIGHT_SHARE 0.05f

/// Which share of the flights that scatter goes by the segment, of a channel: nearly all where the light and
/// the ray's nearest point are close, in mean free paths, so that its light falls faster than what gets
/// through.
FN float equiangular_share(EquiangularSegment s, float length, float extinction) {
  const float at = clamp_f(s.along, 0.0f, length);
  const float share = 0.9f / (1.0f + extinction * extinction * (s.away * s.away + at * at));
  return share < LEAST_SIGHT_SHARE ? 0.0f : share;
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

/// A path that scatters at `distance` of a part of a ray of that length, by the segment or by the medium.
FN FlightWeight weigh_equiangular(FlightWeight before, vec3 extinction, vec3 albedo,
                                  EquiangularSegment segment, vec3 share, float length, float distance) {
  const float least = min_f(min_f(extinction.x, extinction.y), extinction.z);
  const vec3 more = sub(extinction, make_vec3(least, least, least));
  const vec3 collides = mul(extinction, exp3(scale(more, -distance)));
  // All of what is a ratio in the end over what passes of the least extinct channel; of 1e26 times as much
  // the rest is nothing.
  const float equiangular = equiangular_pdf(segment, distance) * exp_f(min_f(least * distance, 60.0f));
  vec3 densities;
  densities.x = equiangular_density(extinction.x, more.x, share.x, length, equiangular, distance);
  densities.y = equiangular_density(extinction.y, more.y, share.y, length, equiangular, distance);
  densities.z = equiangular_density(extinction.z, more.z, share.z, length, equiangular, distance);
  return weigh_flight(before, mul(albedo, collides), densities);
}

PENUMBRA_NAMESPACE_END
#endif
