// Free flights through a homogeneous medium: where a ray scatters, and the path's weight.
//
// A path has one colour channel, its hero, whose extinction samples distances. It also stores the ratios of
// the densities with which each of the three channels would have sampled the path. Its weight is its value
// over the mean of those densities: the balance heuristic over channels (Veach and Guibas 1995; Miller,
// Georgiev and Jarosz 2019). No weight of a channel exceeds three times its albedo, and if all channels are
// equal this is plain sampling. Weights are ratios throughout, so nothing underflows before the light that it
// belongs to. Media that only absorb sample no distances: paths pass, dimmed by exp(-sigma_a L).
#ifndef PENUMBRA_FLIGHT_H
#define PENUMBRA_FLIGHT_H
#include "kernels/math/math.h"
#include "kernels/math/vec3.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

FN float mean3(vec3 v) { return ((v.x + v.y) + v.z) * (1.0f / 3.0f); }

FN vec3 exp3(vec3 v) { return make_vec3(exp_f(v.x), exp_f(v.y), exp_f(v.z)); }

/// The optical depth at which a flight ends, exponentially distributed: -log(1 - u), where `fine` adds 24
/// binary digits to u. Both are in [0, 1 - 2^-24]. The result is at most 33, and accurate near 0.
FN float flight_depth(float u, float fine) {
  const float digits = fine * (1.0f / 16777216.0f);
  const bool low = u < 0.5f;
  const float below = log1p_f(-(low ? u + digits : 0.0f)), above = log_f((1.0f - u) - (low ? 0.0f : digits));
  return low ? -below : -above;
}

/// A path's weight (throughput), and the ratios of its channels' densities, with mean 1.
typedef struct {
  vec3 throughput, channels;
  float density;  ///< factor of the mean density
} FlightWeight;

/// Multiplies the path's value by `value` and the channels' densities by `densities`.
FN FlightWeight weigh_flight(FlightWeight before, vec3 value, vec3 densities) {
  const vec3 channels = mul(before.channels, densities);
  const float mean = mean3(channels), inverse = 1.0f / (mean > 0.0f ? mean : 1.0f);
  FlightWeight after;
  after.throughput = scale(mul(before.throughput, value), inverse);
  after.channels = scale(channels, inverse);
  after.density = before.density * mean;
  return after;
}

FN FlightWeight select_flight_weight(bool condition, FlightWeight yes, FlightWeight no) {
  FlightWeight w;
  w.throughput = select3(condition, yes.throughput, no.throughput);
  w.channels = select3(condition, yes.channels, no.channels);
  w.density = condition ? yes.density : no.density;
  return w;
}

/// Whether a medium of that albedo only absorbs.
FN bool only_absorbs(vec3 albedo) { return !(max_component(albedo) > 0.0f); }

/// A flight of `length` through a homogeneous medium. `scatters`: whether the path scatters at its end; not
/// if the medium only absorbs.
FN FlightWeight weigh_homogeneous(FlightWeight before, vec3 extinction, vec3 albedo, float length,
                                  bool scatters) {
  const bool absorbs = only_absorbs(albedo);
  const float least = absorbs ? 0.0f : min_f(min_f(extinction.x, extinction.y), extinction.z);
  const vec3 more = sub(extinction, make_vec3(least, least, least));
  const vec3 passes = exp3(scale(more, -length));
  const vec3 collides = mul(extinction, passes);
  const vec3 densities = select3(absorbs, make_vec3(1.0f, 1.0f, 1.0f), select3(scatters, collides, passes));
  FlightWeight after = weigh_flight(before, select3(scatters, mul(albedo, collides), passes), densities);
  after.density *= exp_f(-least * length);
  return after;
}

PENUMBRA_NAMESPACE_END
#endif
