// What an arc of a polygon light's outline adds to the reflection in a Phong lobe, for any real exponent.
//
// With w the lobe's axis, n the normal, and A the visible part, clipped at the horizon, Stokes' theorem gives
//   (e + 2) integral over A of max(0, w.u)^e (n.u) du
//       = (n.w) integral over the outline of (1 - max(0, w.u)^e) dphi
//         + sum over its arcs of (n.g) integral of max(0, w.u)^e dpsi
// (Arvo 1995, the double-axis moment, with the recurrence over e summed up), where phi is the azimuth about w
// and psi runs along an arc with unit normal g. On an arc's great circle, with delta = w.g, c^2 =
// 1 - delta^2, and psi from the point closest to w on,
//   w.u = c cos psi,   dphi = delta / S dpsi,   S = 1 - (w.u)^2 = delta^2 + c^2 (sin psi)^2.
// Unlike dphi alone, (1 - (w.u)^e) dphi is smooth where the outline passes w, and says by itself whether w is
// inside: nothing jumps. The width of both integrands is that of the lobe, 1 / sqrt(e), whatever delta is, so
// that a Gauss-Legendre rule of at most 24 nodes over the part of the arc inside the lobe does for every
// exponent; outside the lobe only dphi is left.
//
// For exponents below 8 no such rule follows (cos psi)^e to its ends at +-pi / 2. Unless an arc is short and
// away from them, they are reached from e + 2k >= 8 by
//   (e + 1) D(e) = (e + 2) D(e + 2) / c^2 - [(w.u)^e cos psi sin psi],   B(e) = B(e + 2) - delta D(e)
// for D = integral of (w.u)^e dpsi and B = integral of (1 - (w.u)^e) dphi.
#ifndef PENUMBRA_POLYGON_LOBE_H
#define PENUMBRA_POLYGON_LOBE_H
#include "kernels/vec3_double.h"

PENUMBRA_NAMESPACE_BEGIN

#define LOWEST_LOBE_EXPONENT 8.0  // of the quadrature
#define LOBE_STEPS 4              // from there down to 0
// ln 1e-10: where the lobe is less than that it counts as 0, which changes a reflected part by less than
// 1e-11 for each arc.
#define LOG_LOBE_CUT (-23.025850929940457)

/// An arc as a lobe sees it.
typedef struct {
  double middle, half_width;  ///< psi of the part inside the lobe
  double delta;               ///< w.g
  double outside;             ///< integral of dphi over the rest of the arc
  double from_cos, from_sin;  ///< of psi at its ends
  double to_cos, to_sin;
  bool stepped;  ///< its exponent is to be reached from a higher one
} LobeArc;

/// delta^2, never 1: c^2 is never 0.
FN double lobe_delta2(double delta) { return min_d(delta * delta, 0.99999999999999989); }

/// For the arc of `angle`, sine and cosine of it not normalised, that starts at `from` with unit normal g.
/// Inside the lobe (w.u)^2 is above `cut2`, or above c^2 times it for a low exponent.
FN LobeArc lobe_arc(vec3d from, vec3d g, double sine, double cosine, double angle, vec3d w, double cut2,
                    bool low_exponent) {
  LobeArc arc;
  const double delta = dot3_d(w, g);
  const double x = dot3_d(from, w), y = dot3_d(from, cross3_d(g, w));
  const double r2 = x * x + y * y, t2 = sine * sine + cosine * cosine;
  const double r = 1.0 / SQRT_D(r2 > 0.0 ? r2 : 1.0), t = 1.0 / SQRT_D(t2 > 0.0 ? t2 : 1.0);
  const double ac = r2 > 0.0 ? x * r : 1.0, as = r2 > 0.0 ? y * r : 0.0;
  const double turn_c = t2 > 0.0 ? cosine * t : 1.0, turn_s = t2 > 0.0 ? sine * t : 0.0;
  const double bc = ac * turn_c - as * turn_s, bs = as * turn_c + ac * turn_s;
  // The arc is shorter than half a turn: it enters the lobe, if from outside, at -acos of the least cosine,
  // leaves it at the positive one, and passes through all of it if psi goes from negative to positive.
  const double least2 = min_d(low_exponent ? cut2 : cut2 / (1.0 - lobe_delta2(delta)), 1.0);
  const double least = SQRT_D(least2), reach = SQRT_D(1.0 - least2);
  const bool from_inside = ac > least, to_inside = bc > least;
  const bool any = (from_inside | to_inside | ((as < 0.0) & (bs > 0.0))) & (least2 < 1.0);
  const bool whole = from_inside & to_inside & any;
  const double low_c = any ? (from_inside ? ac : least) : ac, low_s = any ? (from_inside ? as : -reach) : as;
  const double high_c = any ? (to_inside ? bc : least) : ac, high_s = any ? (to_inside ? bs : reach) : as;
  const double low = atan2_d(low_s, low_c), high = atan2_d(high_s, high_c);
  // A short arc's own angle has more digits than the difference.
  arc.half_width = any ? 0.5 * (whole ? angle : max_d(high - low, 0.0)) : 0.0;
  arc.middle = any ? (whole ? low + 0.5 * angle : 0.5 * (low + high)) : 0.0;
  // The differences of step_down would cost a small light its digits. A rule of 8 nodes converges like
  // 5.8^-16 where the next singularity is as far from its interval's end as the interval is long.
  const double farthest = max_d(FABS_D(low), FABS_D(high));
  arc.stepped = low_exponent & !(whole & (HALF_PI_D - farthest >= angle));
  // The direction of azimuth phi is (delta cos psi, sin psi). Two parts are outside, and make less than half
  // a turn together; in the direction that delta says, whatever rounding does to half a turn.
  const double ax = delta * ac, bx = delta * bc, low_x = delta * low_c, high_x = delta * high_c;
  const double in_x = low_x * ax + low_s * as, in_y = low_s * ax - low_x * as;
  const double out_x = bx * high_x + bs * high_s, out_y = bs * high_x - bx * high_s;
  const double turn = atan2_d(FABS_D(in_x * out_y + in_y * out_x), in_x * out_x - in_y * out_y);
  arc.outside = delta > 0.0 ? turn : (delta < 0.0 ? -turn : 0.0);
  arc.delta = delta;
  arc.from_cos = ac;
  arc.from_sin = as;
  arc.to_cos = bc;
  arc.to_sin = bs;
  return arc;
}

/// (w.u)^e at psi, and in `rest` (1 - (w.u)^e) / S.
FN double lobe_at(double psi, double delta2, double log_c2, double half_exponent, PRIVATE double* rest) {
  const double sine = sin_d(psi);
  const double s2 = sine * sine;
  double complement;
  const double power = exp_and_rest_d(half_exponent * (log1p_d(-s2) + log_c2), &complement);
  *rest = complement / max_d(delta2 + (1.0 - delta2) * s2, 1e-300);
  return power;
}

/// (w.u)^e cos psi sin psi for e = 2 `half_exponent` at an end of an arc, 0 behind; and in `inverse` what
/// makes (w.u)^(e - 2) of (w.u)^e.
FN double lobe_end(double cosine, double sine, double c2, double half_exponent, PRIVATE double* inverse) {
  const double front = max_d(cosine, 0.0);
  const double g = max_d(c2 * front * front, 1e-30);
  *inverse = 1.0 / g;
  return exp_d(half_exponent * log_d(g)) * front * sine;
}

/// Takes `steps` steps of 2 down from the exponent 2 `half_exponent`: D in `power`, B in `rest`.
FN void step_down(double delta, double from_cos, double from_sin, double to_cos, double to_sin,
                  double half_exponent, double steps, PRIVATE double* power, PRIVATE double* rest) {
  const double c2 = 1.0 - lobe_delta2(delta);
  double from_inverse, to_inverse;
  double from = lobe_end(from_cos, from_sin, c2, half_exponent - 1.0, &from_inverse);
  double to = lobe_end(to_cos, to_sin, c2, half_exponent - 1.0, &to_inverse);
  double d = *power, b = *rest, e = 2.0 * half_exponent - 2.0;
  UNROLL
  for (int i = 0; i < LOBE_STEPS; i++) {
    const bool active = (double)i < steps;
    d = active ? ((e + 2.0) * d / c2 - (to - from)) / (e + 1.0) : d;
    b = active ? b - delta * d : b;
    from *= from_inverse;
    to *= to_inverse;
    e = active ? e - 2.0 : e;
  }
  *power = d;
  *rest = b;
}

PENUMBRA_NAMESPACE_END
#endif
