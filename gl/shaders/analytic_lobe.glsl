// The Phong lobe, one at a time, with the formulas and rules of kernels/polygon/polygon_lobe.h.
#include "kernels/polygon/polygon_lobe.h"

CONSTANT float lobe_nodes[24] = float[24](LOBE_NODES_8, LOBE_NODES_16, LOBE_NODES_24);
CONSTANT float lobe_weights[24] = float[24](LOBE_WEIGHTS_8, LOBE_WEIGHTS_16, LOBE_WEIGHTS_24);

struct Lobe {
  vec3 n, w;            // the receiver's normal and mirror direction
  float half_exponent;  // of the lobe
  float steps;  // of 2, up to the quadrature's exponent
  float cut2;           // see lobe_arc
  float height;         // n.w
};

Lobe start_lobe(vec3 n, vec3 w, float exponent) {
  Lobe lobe;
  lobe.n = n;
  lobe.w = w;
  lobe.half_exponent = 0.5 * exponent;
  lobe.steps = lobe_steps(exponent);
  lobe.cut2 = exp_d(LOG_LOBE_CUT / (lobe.half_exponent + lobe.steps));
  lobe.height = dot3_d(w, n);
  return lobe;
}

// An arc of a light's outline as the receiver sees it, or of the receiver's horizon.
struct Arc {
  vec3 from, normal;           // the normal is unit
  float sine, cosine, angle;  // sine and cosine are not normalised
  float weight;                // in the sum
};

// The arc's contribution to (e + 2) times the lobe's integral.
float lobe_arc_sum(Lobe lobe, Arc a) {
  LobeArc arc = lobe_arc(a.from, a.normal, a.sine, a.cosine, a.angle, lobe.w, lobe.cut2, lobe.steps > 0.0);
  float half_exponent = lobe.half_exponent + (arc.stepped ? lobe.steps : 0.0);
  int count = int(lobe_rule(lobe.half_exponent + lobe.steps, arc.half_width));
  int first = count == 12 ? 12 : (count == 8 ? 4 : 0);
  float delta2 = lobe_delta2(arc.delta), log_c2 = log1p_d(-delta2);
  LobeTerms terms;
  terms.power = terms.rest = 0.0;
  for (int k = first; k < first + count; k++) {
    float off = lobe_nodes[k] * arc.half_width, weight = lobe_weights[k] * arc.half_width;
    LobeTerms below = lobe_at(arc.middle - off, delta2, log_c2, half_exponent);
    LobeTerms above = lobe_at(arc.middle + off, delta2, log_c2, half_exponent);
    terms.power += weight * (below.power + above.power);
    terms.rest += weight * (below.rest + above.rest);
  }
  terms.rest = arc.delta * terms.rest + arc.outside;
  if (arc.stepped)
    terms = step_down(arc.delta, arc.from_cos, arc.from_sin, arc.to_cos, arc.to_sin, half_exponent,
                      lobe.steps, terms);
  return a.weight * (lobe.height * terms.rest + dot3_d(lobe.n, a.normal) * terms.power);
}

Arc edge_arc(VisibleEdge e, float angle) {
  Arc arc;
  arc.from = e.from;
  arc.normal = e.normal;
  arc.sine = e.sine;
  arc.cosine = e.cosine;
  arc.angle = angle;
  arc.weight = angle > 0.0 ? 1.0 : 0.0;
  return arc;
}

// Points where outlines cross the horizon: see Horizon of kernels/polygon/polygon_light.h.
struct Crossings {
  vec3 a, b;
  float open;  // not 0: `a` is waiting for `b`
  float pair;  // 1: the arc is from a to b; -1: from b to a; 0: not yet
};

Crossings no_crossings() {
  Crossings c;
  c.a = c.b = vec3(0.0);
  c.open = c.pair = 0.0;
  return c;
}

// Adds an edge's crossing, if no pair is waiting.
Crossings join_crossing(Crossings c, VisibleEdge e) {
  if (e.crossing == 0.0) return c;
  vec3 q = e.crossing > 0.0 ? e.from : e.to;
  bool opens = c.open == 0.0;
  if (opens)
    c.a = q;
  else
    c.b = q;
  c.pair = opens ? 0.0 : e.crossing;
  c.open = opens ? e.crossing : 0.0;
  return c;
}

// The arc along the horizon between the points of a pair.
Arc horizon_arc(Crossings c, vec3 n) {
  float turn = dot3_d(n, cross3_d(c.a, c.b));
  Arc arc;
  arc.from = c.a;
  arc.normal = turn < 0.0 ? -n : n;
  arc.sine = abs(turn);
  arc.cosine = dot3_d(c.a, c.b);
  arc.angle = atan2_d(arc.sine, arc.cosine);
  arc.weight = c.pair;
  return arc;
}
