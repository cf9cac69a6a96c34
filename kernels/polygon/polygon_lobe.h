// The contribution of an arc of a polygon light's outline to the reflection in a Phong lobe, for any real
// exponent.
//
// Let w be the lobe's axis, n the normal, and A the visible part, clipped at the horizon. Stokes' theorem
// gives
//   (e + 2) integral over A of max(0, w.u)^e (n.u) du
//       = (n.w) integral over the outline of (1 - max(0, w.u)^e) dphi
//         + sum over its arcs of (n.g) integral of max(0, w.u)^e dpsi
// (Arvo 1995, the double-axis moment, with the recurrence over e summed up), where phi is the azimuth about w
// and psi runs along an arc with unit normal g. On an arc's great circle, with delta = w.g, c^2 = 1 -
// delta^2, and psi measured from the point closest to w,
//   w.u = c cos psi,   dphi = delta / S dpsi,   S = 1 - (w.u)^2 = delta^2 + c^2 (sin psi)^2.
// Unlike dphi alone, (1 - (w.u)^e) dphi is smooth where the outline passes w, and includes whether w is
// inside: there are no jumps. The width of both integrands is that of the lobe, 1 / sqrt(e), for any delta.
// So a Gauss-Legendre rule of at most 24 nodes over the part of the arc inside the lobe is enough for every
// exponent; outside the lobe only dphi remains.
//
// For exponents below 8 no such rule resolves (cos psi)^e at its ends, +-pi / 2. Unless an arc is short and
// away from them, these exponents are computed from e + 2k >= 8 by
//   (e + 1) D(e) = (e + 2) D(e + 2) / c^2 - [(w.u)^e cos psi sin psi],   B(e) = B(e + 2) - delta D(e)
// for D = integral of (w.u)^e dpsi and B = integral of (1 - (w.u)^e) dphi.
#ifndef PENUMBRA_POLYGON_LOBE_H
#define PENUMBRA_POLYGON_LOBE_H
#include "kernels/math/vec3_double.h"

PENUMBRA_NAMESPACE_BEGIN

#define LOWEST_LOBE_EXPONENT 8.0  // lowest exponent of the quadrature
#define LOBE_STEPS 4              // steps from there down to 0
// ln 1e-10: where the lobe is below this it counts as 0, which changes the reflected fraction by less than
// 1e-11 per arc.
#define LOG_LOBE_CUT (-23.025850929940457)

/// An arc relative to a lobe.
STRUCT(LobeArc) {
  double middle, half_width;  ///< in psi, of the part inside the lobe
  double delta;               ///< w.g
  double outside;             ///< integral of dphi over the rest of the arc
  double from_cos, from_sin;  ///< of psi at the ends of the arc
  double to_cos, to_sin;
  bool stepped;  ///< computed from a higher exponent
};

/// delta^2, never 1: c^2 is never 0.
FN double lobe_delta2(double delta) { return min_d(delta * delta, ONE_MINUS_EPSILON_D); }

/// For the arc of `angle` that starts at `from`, with unit normal g; sine and cosine of the angle are not
/// normalised. Inside the lobe (w.u)^2 is above `cut2`, or above c^2 cut2 for a low exponent.
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
  // The arc is shorter than half a turn. If it starts outside, it enters the lobe at -acos(least). It leaves
  // the lobe at acos(least). It passes through the whole lobe if psi goes from negative to positive.
  const double least2 = min_d(low_exponent ? cut2 : cut2 / (1.0 - lobe_delta2(delta)), 1.0);
  const double least = SQRT_D(least2), reach = SQRT_D(1.0 - least2);
  const bool from_inside = ac > least, to_inside = bc > least;
  const bool passes = BOTH(as < 0.0, 0.0 < bs), enters = EITHER(EITHER(from_inside, to_inside), passes);
  const bool any = BOTH(enters, least2 < 1.0);
  const bool whole = BOTH(BOTH(from_inside, to_inside), any);
  const double low_c = any ? (from_inside ? ac : least) : ac, low_s = any ? (from_inside ? as : -reach) : as;
  const double high_c = any ? (to_inside ? bc : least) : ac, high_s = any ? (to_inside ? bs : reach) : as;
  const double low = atan2_d(low_s, low_c), high = atan2_d(high_s, high_c);
  // A short arc's own angle has more digits than the difference.
  arc.half_width = any ? 0.5 * (whole ? angle : max_d(high - low, 0.0)) : 0.0;
  arc.middle = any ? (whole ? low + 0.5 * angle : 0.5 * (low + high)) : 0.0;
  // The differences in step_down would cost a small light its digits. A rule of 8 nodes converges like
  // 5.8^-16 if the next singularity is as far from the interval's end as the interval is long.
  const double farthest = max_d(FABS_D(low), FABS_D(high));
  arc.stepped = BOTH(low_exponent, !BOTH(whole, HALF_PI_D - farthest >= angle));
  // The direction of azimuth phi is (delta cos psi, sin psi). The two parts outside the lobe make less than
  // half a turn together; the sign of delta gives the direction, despite rounding near half a turn.
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

/// Integrands at one point, or integrals, of a lobe along an arc.
STRUCT(LobeTerms) {
  double power;  ///< (w.u)^e; integral: D
  double rest;   ///< (1 - (w.u)^e) / S; integral times delta: B
};

/// The integrands at psi.
FN LobeTerms lobe_at(double psi, double delta2, double log_c2, double half_exponent) {
  const double sine = sin_d(psi);
  const double s2 = sine * sine;
  const ExpAndRest lobe = exp_and_rest_of_d(half_exponent * (log1p_d(-s2) + log_c2));
  LobeTerms terms;
  terms.power = lobe.power;
  terms.rest = lobe.rest / max_d(delta2 + (1.0 - delta2) * s2, TINY_D);
  return terms;
}

/// One end of an arc.
STRUCT(LobeEnd) {
  double value;    ///< (w.u)^e cos psi sin psi, 0 behind the lobe
  double inverse;  ///< factor from (w.u)^e to (w.u)^(e - 2)
};

/// For e = 2 `half_exponent`.
FN LobeEnd lobe_end(double cosine, double sine, double c2, double half_exponent) {
  const double front = max_d(cosine, 0.0);
  const double g = max_d(c2 * front * front, 1e-30);
  LobeEnd end;
  end.inverse = 1.0 / g;
  end.value = exp_d(half_exponent * log_d(g)) * front * sine;
  return end;
}

/// Takes `steps` steps of -2 from the exponent 2 `half_exponent`: D in `power`, B in `rest`.
FN LobeTerms step_down(double delta, double from_cos, double from_sin, double to_cos, double to_sin,
                       double half_exponent, double steps, LobeTerms terms) {
  const double c2 = 1.0 - lobe_delta2(delta);
  const LobeEnd from_end = lobe_end(from_cos, from_sin, c2, half_exponent - 1.0);
  const LobeEnd to_end = lobe_end(to_cos, to_sin, c2, half_exponent - 1.0);
  double from = from_end.value, to = to_end.value;
  double d = terms.power, b = terms.rest, e = 2.0 * half_exponent - 2.0;
  UNROLL
  for (int i = 0; i < LOBE_STEPS; i++) {
    const bool wanted = i < steps;
    d = wanted ? ((e + 2.0) * d / c2 - (to - from)) / (e + 1.0) : d;
    b = wanted ? b - delta * d : b;
    from *= from_end.inverse;
    to *= to_end.inverse;
    e = wanted ? e - 2.0 : e;
  }
  LobeTerms stepped;
  stepped.power = d;
  stepped.rest = b;
  return stepped;
}

/// Number of steps of 2 from the exponent to LOWEST_LOBE_EXPONENT or above.
FN double lobe_steps(double exponent) {
  double steps = 0.0;
  UNROLL
  for (int i = 0; i < LOBE_STEPS; i++) steps += exponent < LOWEST_LOBE_EXPONENT - 2.0 * i ? 1.0 : 0.0;
  return steps;
}

/// Half the number of nodes of the rule for a part of an arc inside the lobe; `half_exponent` is that of the
/// quadrature. The rules of 8, 16 and 24 nodes have errors below 1e-10 up to lengths of 3, 8.7 and 13.6
/// widths of the lobe; 13.6 is the whole lobe.
FN double lobe_rule(double half_exponent, double half_width) {
  const double exponent = 2.0 * half_exponent;
  const double length2 = 4.0 * half_width * half_width * exponent;
  return length2 <= 0.0 ? 0.0 : (length2 <= 9.0 ? 4.0 : (length2 <= 75.0 ? 8.0 : 12.0));
}

// Positive nodes of the Gauss-Legendre rules, and their weights.
#define LOBE_NODES_8 0.96028985649753623, 0.79666647741362674, 0.52553240991632899, 0.1834346424956498
#define LOBE_NODES_16                                                                                      \
  0.98940093499164993, 0.94457502307323258, 0.86563120238783174, 0.75540440835500303, 0.61787624440264375, \
      0.45801677765722739, 0.28160355077925891, 0.09501250983763744
#define LOBE_NODES_24                                                                                     \
  0.99518721999702136, 0.9747285559713095, 0.93827455200273276, 0.88641552700440103, 0.82000198597390292, \
      0.74012419157855436, 0.64809365193697557, 0.54542147138883954, 0.43379350762604514,                 \
      0.31504267969616337, 0.19111886747361631, 0.064056892862605626
#define LOBE_WEIGHTS_8 0.10122853629037626, 0.22238103445337447, 0.31370664587788729, 0.36268378337836198
#define LOBE_WEIGHTS_16                                                                  \
  0.027152459411754095, 0.062253523938647893, 0.095158511682492785, 0.12462897125553387, \
      0.14959598881657673, 0.16915651939500254, 0.18260341504492359, 0.1894506104550685
#define LOBE_WEIGHTS_24                                                                      \
  0.0123412297999872, 0.028531388628933663, 0.044277438817419806, 0.059298584915436781,      \
      0.073346481411080306, 0.086190161531953276, 0.097618652104113888, 0.10744427011596563, \
      0.1155056680537256, 0.12167047292780339, 0.1258374563468283, 0.12793819534675216

PENUMBRA_NAMESPACE_END
#endif
