// LANES shading points for which a polygon light's closed forms are computed, and the contribution of one arc
// per lane to their lobes, by Gauss-Legendre quadrature.
#ifndef PENUMBRA_POLYGON_LOBE_LANES_H
#define PENUMBRA_POLYGON_LOBE_LANES_H
#include "kernels/polygon/polygon_lobe.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  double px[LANES], py[LANES], pz[LANES];  ///< position, relative to the scene's centre
  double nx[LANES], ny[LANES], nz[LANES];  ///< unit shading normal on the side of wo
  double wx[LANES], wy[LANES], wz[LANES];  ///< unit mirror direction of wo about the normal, at most rounding
                                           ///< below the horizon
  double exponent[LANES];                  ///< of the Phong lobe, any real number from 0; negative: no lobe
  // Instead of the Phong lobe, in scenes that need it, a linearly transformed cosine: the unit x axis of its
  // frame, the inverse widths of its matrix (see Ltc), 0 for no lobe, and the shift.
  double tx[LANES], ty[LANES], tz[LANES];
  double inverse_x[LANES], inverse_y[LANES], shift[LANES];
} Receivers;

/// The data of the lobes that all arcs share.
typedef struct {
  double half_exponent[LANES];
  double steps[LANES];   ///< steps of 2 from the lobe's exponent to LOWEST_LOBE_EXPONENT or above
  double cut2[LANES];    ///< see lobe_arc; above 1: no lobe
  double height[LANES];  ///< n.w
} Lobes;

/// An arc for each lane.
typedef struct {
  double middle[LANES], half_width[LANES], delta[LANES], outside[LANES];
  double from_cos[LANES], from_sin[LANES], to_cos[LANES], to_sin[LANES];
  double half_exponent[LANES];  ///< exponent of its quadrature, halved
  double steps[LANES];          ///< steps from there down to the lobe's exponent
  double rise[LANES];           ///< n.g
  double weight[LANES];         ///< in the sum
} LobeArcs;

/// Initialises the lobes. Returns whether any lane has one.
STAGE bool start_lobes(const PRIVATE Receivers* RESTRICT r, PRIVATE Lobes* RESTRICT lobes) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const double e = r->exponent[j];
      const double steps = lobe_steps(e);
      lobes->steps[j] = steps;
      lobes->half_exponent[j] = 0.5 * max_d(e, 0.0);
      const double cut2 = exp_d(LOG_LOBE_CUT / (lobes->half_exponent[j] + steps));
      lobes->cut2[j] = e >= 0.0 ? cut2 : 2.0;
      lobes->height[j] = r->wx[j] * r->nx[j] + r->wy[j] * r->ny[j] + r->wz[j] * r->nz[j];
    }
  bool any = false;
  for (int j = 0; j < LANES; j++) any |= r->exponent[j] >= 0.0;
  return any;
}

/// Sets lane j's arc, which starts at `from`.
FN void store_lobe_arc(PRIVATE LobeArcs* arcs, int j, const PRIVATE Lobes* lobes, vec3d from, vec3d g,
                       double sine, double cosine, double angle, vec3d n, vec3d w, double weight) {
  const LobeArc arc = lobe_arc(from, g, sine, cosine, angle, w, lobes->cut2[j], lobes->steps[j] > 0.0);
  arcs->middle[j] = arc.middle;
  arcs->half_width[j] = weight != 0.0 ? arc.half_width : 0.0;
  arcs->delta[j] = arc.delta;
  arcs->outside[j] = arc.outside;
  arcs->from_cos[j] = arc.from_cos;
  arcs->from_sin[j] = arc.from_sin;
  arcs->to_cos[j] = arc.to_cos;
  arcs->to_sin[j] = arc.to_sin;
  arcs->steps[j] = arc.stepped ? lobes->steps[j] : 0.0;
  arcs->half_exponent[j] = lobes->half_exponent[j] + arcs->steps[j];
  arcs->rise[j] = dot3_d(n, g);
  arcs->weight[j] = weight;
}

/// Half the number of nodes of the rule for lane j's arc. Each lane chooses its own, so that its result does
/// not depend on its neighbours.
FN double lane_rule(const PRIVATE Lobes* lobes, const PRIVATE LobeArcs* arcs, int j) {
  return lobe_rule(lobes->half_exponent[j] + lobes->steps[j], arcs->half_width[j]);
}

/// Integrals of (w.u)^e and of (1 - (w.u)^e) / S over psi inside the lobe, with up to `most` nodes on each
/// side of the middle.
STAGE void integrate_lobes(const PRIVATE Lobes* RESTRICT lobes, const PRIVATE LobeArcs* RESTRICT arcs,
                           int most, PRIVATE double* RESTRICT power, PRIVATE double* RESTRICT rest) {
  // Weights after each rule's last node are 0.
  const double nodes8[12] = {LOBE_NODES_8};
  const double nodes16[12] = {LOBE_NODES_16};
  const double nodes24[12] = {LOBE_NODES_24};
  const double weights8[12] = {LOBE_WEIGHTS_8};
  const double weights16[12] = {LOBE_WEIGHTS_16};
  const double weights24[12] = {LOBE_WEIGHTS_24};
  double log_c2[LANES], rule[LANES];
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      log_c2[j] = log1p_d(-lobe_delta2(arcs->delta[j]));
      rule[j] = lane_rule(lobes, arcs, j);
      power[j] = rest[j] = 0.0;
    }
  for (int k = 0; k < most; k++) {
    const double node8 = nodes8[k], node16 = nodes16[k], node24 = nodes24[k];
    const double weight8 = weights8[k], weight16 = weights16[k], weight24 = weights24[k];
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        const bool short_rule = rule[j]<6.0, long_rule = rule[j]> 10.0;
        const double node = short_rule ? node8 : (long_rule ? node24 : node16);
        const double weight = short_rule ? weight8 : (long_rule ? weight24 : weight16);
        const double delta2 = lobe_delta2(arcs->delta[j]), offset = node * arcs->half_width[j];
        const double half_exponent = arcs->half_exponent[j];
        const LobeTerms below = lobe_at(arcs->middle[j] - offset, delta2, log_c2[j], half_exponent);
        const LobeTerms above = lobe_at(arcs->middle[j] + offset, delta2, log_c2[j], half_exponent);
        power[j] += weight * (below.power + above.power);
        rest[j] += weight * (below.rest + above.rest);
      }
  }
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      power[j] *= arcs->half_width[j];
      rest[j] *= arcs->half_width[j];
    }
}

/// Steps D and B from the quadrature's exponent down to the lobe's.
STAGE void step_lobes_down(const PRIVATE LobeArcs* RESTRICT arcs, PRIVATE double* RESTRICT power,
                           PRIVATE double* RESTRICT rest) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      LobeTerms terms;
      terms.power = power[j];
      terms.rest = rest[j];
      terms = step_down(arcs->delta[j], arcs->from_cos[j], arcs->from_sin[j], arcs->to_cos[j],
                        arcs->to_sin[j], arcs->half_exponent[j], arcs->steps[j], terms);
      power[j] = terms.power;
      rest[j] = terms.rest;
    }
}

/// Adds each lane's arc to its sum.
STAGE void add_lobe_arcs(const PRIVATE Lobes* RESTRICT lobes, const PRIVATE LobeArcs* RESTRICT arcs,
                         PRIVATE double* RESTRICT sum) {
  double power[LANES], rest[LANES];
  double most = 0.0, most_steps = 0.0;
  for (int j = 0; j < LANES; j++) {
    most = max_d(most, lane_rule(lobes, arcs, j));
    most_steps = max_d(most_steps, arcs->steps[j]);
    power[j] = rest[j] = 0.0;
  }
  if (most > 0.0) integrate_lobes(lobes, arcs, (int)most, power, rest);
  for (int j = 0; j < LANES; j++) rest[j] = arcs->delta[j] * rest[j] + arcs->outside[j];
  if (most_steps > 0.0) step_lobes_down(arcs, power, rest);
  for (int j = 0; j < LANES; j++)
    sum[j] += arcs->weight[j] * (lobes->height[j] * rest[j] + arcs->rise[j] * power[j]);
}

PENUMBRA_NAMESPACE_END
#endif
