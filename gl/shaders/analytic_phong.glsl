// Reflection of polygon lights by a diffuse or glossy surface.
#include "kernels/polygon/polygon_edge.h"
#include "gl/shaders/analytic_lobe.glsl"

uniform samplerBuffer polygon_corners;  // p, starts

struct Receiver {
  vec3 p, n;
  vec3 diffuse, specular;
  bool glossy;
  Lobe lobe;
};

Receiver receiver_at(Surface s, vec3 d, vec4 diffuse, vec4 specular) {
  Receiver r;
  r.p = s.p;
  r.n = s.shading;
  r.diffuse = diffuse.xyz;
  r.specular = specular.xyz;
  r.glossy = specular.w > 0.0;
  r.lobe = start_lobe(r.n, normalize(d - 2.0 * dot(r.n, d) * r.n), r.glossy ? diffuse.w : 0.0);
  return r;
}

// Reflected radiance from the outline of these corners, for a light of radiance 1. One iteration of the loop
// processes an edge, or an arc of the horizon that the edges so far have closed: one piece of code for both,
// since neighbouring pixels execute iterations together.
vec3 reflected_of_polygon(Receiver r, int first, int end, bool two_sided) {
  IrradianceSum edges = no_irradiance();
  Crossings crossings = no_crossings();
  float arcs = 0.0;
  vec3 from = texelFetch(polygon_corners, first).xyz - camera_origin;
  for (int i = first + 1; i < end || crossings.pair != 0.0;) {
    Arc arc;
    if (crossings.pair != 0.0) {
      arc = horizon_arc(crossings, r.n);
      crossings.pair = 0.0;
    } else {
      vec4 corner = texelFetch(polygon_corners, i++);
      vec3 to = corner.xyz - camera_origin;
      VisibleEdge e = visible_edge(from - r.p, to - r.p, to - from, r.n);
      from = to;
      if (corner.w != 0.0) continue;  // another loop of the outline
      float angle = atan2_d(e.sine, e.cosine);
      edges = add_irradiance(edges, e, angle, r.n);
      arc = edge_arc(e, angle);
      if (r.glossy) crossings = join_crossing(crossings, e);
    }
    if (r.glossy && arc.weight != 0.0) arcs += lobe_arc_sum(r.lobe, arc);
  }
  float lobe = -0.5 / PI_D * arcs;
  return r.diffuse * (total_irradiance(edges, two_sided) / PI_D) +
         r.specular * max(two_sided ? abs(lobe) : lobe, 0.0);
}
