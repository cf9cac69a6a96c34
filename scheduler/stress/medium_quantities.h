// Quantities of participating media. See quantities.h.
#ifndef PENUMBRA_STRESS_MEDIUM_QUANTITIES_H
#define PENUMBRA_STRESS_MEDIUM_QUANTITIES_H
#include "kernels/bsdf/phase.h"
#include "kernels/medium/equiangular.h"
#include "kernels/medium/flight.h"
#include "scheduler/stress/quantity_numbers.h"

PENUMBRA_NAMESPACE_BEGIN

/// In: g, versine (see henyey_greenstein), u, size N of a grid. Out: density; sine and cosine of the angle to
/// the z axis that is sampled with u; means of the cosine mu, and of (3 mu^2 - 1) / 2, over N samples at the
/// centres of the cells of u.
STAGE void phase_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const vec3 z = make_vec3(0.0f, 0.0f, 1.0f);
  const float g = in_f(in, 0);
  const vec3 w = sample_henyey_greenstein(z, g, in_f(in, 2), 0.0f);
  const int size = (int)in[3];
  double first = 0.0, second = 0.0;
  for (int i = 0; i < size; i++) {
    const double mu = sample_henyey_greenstein(z, g, ((float)i + 0.5f) / (float)size, 0.0f).z;
    first += mu;
    second += 1.5 * mu * mu - 0.5;
  }
  out[0] = henyey_greenstein(g, in_f(in, 1));
  out[1] = SQRT(sqr(w.x) + sqr(w.y));
  out[2] = w.z;
  out[3] = first / max_d((double)size, 1.0);
  out[4] = second / max_d((double)size, 1.0);
}

/// In: u, fine. Out: the sampled optical depth of a flight.
STAGE void flight_depth_quantity(GLOBAL const double* in, GLOBAL double* out) {
  out[0] = flight_depth(in_f(in, 0), in_f(in, 1));
}

/// In: extinction, albedo, length, whether the path scatters there. Out: the path's throughput per channel
/// after that flight; the ratios of the channels' densities; the factor of the mean density.
STAGE void flight_weight_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const vec3 one = make_vec3(1.0f, 1.0f, 1.0f);
  const FlightWeight before = {one, one, 1.0f};
  const FlightWeight after = weigh_homogeneous(before, in_v(in, 0), in_v(in, 3), in_f(in, 6), in[7] != 0.0);
  out_v(out, 0, after.throughput);
  out_v(out, 3, after.channels);
  out[6] = after.density;
}

/// In: origin, direction, place, length, size, u. Out: equiangular sample: the distance at the fraction u of
/// the angle; the angle.
STAGE void sight_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const EquiangularSegment segment =
      equiangular_segment(in_v(in, 0), in_v(in, 3), in_f(in, 9), in_v(in, 6), in_f(in, 10));
  out[0] = equiangular_distance(segment, in_f(in, 11));
  out[1] = segment.angle;
}

PENUMBRA_NAMESPACE_END
#endif
