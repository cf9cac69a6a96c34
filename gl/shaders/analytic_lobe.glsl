// One Phong lobe at a time, by the formulas and rules of kernels/polygon_lobe.h.
#include "kernels/polygon_lobe.h"

CONSTANT float lobe_nodes[24] = float[24](LOBE_NODES_8, LOBE_NODES_16, LOBE_NODES_24);
CONSTANT float lobe_weights[24] = float[24](LOBE_WEIGHTS_8, LOBE_WEIGHTS_16, LOBE_WEIGHTS_24);

struct Lobe {
  vec3 n, w;            // the receiver's normal and mirror direction
  float half_exponent;  // of the lobe
  float steps;          // of 2 up to the quadrature's exponent
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

// What an arc that starts at `from`, with unit normal g, adds to (e + 2) times the lobe's integral.
float lobe_arc_sum(Lobe lobe, vec3 from, vec3 g, float sine, float cosine, float angle) {
  LobeArc arc = lobe_arc(from, g, sine, cosine, angle, lobe.w, lobe.cut2, lobe.steps > 0.0);
  float half_exponent = lobe.half_exponent + (arc.stepped ? lobe.steps : 0.0);
  int count = int(lobe_rule(lobe.half_exponent + lobe.steps, arc.half_width));
  int first = count == 12 ? 12 : (count == 8 ? 4 : 0);
  float delta2 = lobe_delta2(arc.delta), log_c2 = log1p_d(-delta2);
  LobeTerms terms;
  terms.power = terms.rest = 0.0;
  for (int k = first; k < first + count; k++) {
    float distance = lobe_nodes[k] * arc.half_width, weight = lobe_weights[k] * arc.half_width;
    LobeTerms below = lobe_at(arc.middle - distance, delta2, log_c2, half_exponent);
    LobeTerms above = lobe_at(arc.middle + distance, delta2, log_c2, half_exponent);
    terms.power += weight * (below.power + above.power);
    terms.rest += weight * (below.rest + above.rest);
  }
  terms.rest = arc.delta * terms.rest + arc.outside;
  if (arc.stepped)
    terms = step_down(arc.delta, arc.from_cos, arc.from_sin, arc.to_cos, arc.to_sin, half_exponent, lobe.steps, terms);
  return lobe.height * terms.rest + dot3_d(lobe.n, g) * terms.power;
}

// See Horizon of kernels/polygon_light.h.
struct LobeSum {
  float sum;
  float open;  // not 0: a crossing at `a` waits for the next one
  vec3 a;
};

// Adds an edge with its angle.
LobeSum add_lobe(LobeSum s, Lobe lobe, VisibleEdge e, float angle) {
  if (angle > 0.0) s.sum += lobe_arc_sum(lobe, e.from, e.normal, e.sine, e.cosine, angle);
  if (e.crossing == 0.0) return s;
  vec3 q = e.crossing > 0.0 ? e.from : e.to;
  if (s.open == 0.0) {
    s.open = e.crossing;
    s.a = q;
    return s;
  }
  float turn = dot3_d(lobe.n, cross3_d(s.a, q)), cosine = dot3_d(s.a, q), sine = abs(turn);
  vec3 g = turn < 0.0 ? -lobe.n : lobe.n;
  s.sum += e.crossing * lobe_arc_sum(lobe, s.a, g, sine, cosine, atan2_d(sine, cosine));
  s.open = 0.0;
  return s;
}
