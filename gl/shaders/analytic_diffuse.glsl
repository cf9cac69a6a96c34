// Reflection of polygon lights by a diffuse surface.
#include "kernels/polygon/polygon_edge.h"

uniform samplerBuffer polygon_corners;  // p, starts

struct Receiver {
  vec3 p, n;
  vec3 diffuse;
};

Receiver receiver_at(Surface s, vec3 d, vec4 diffuse, vec4 specular) {
  Receiver r;
  r.p = s.p;
  r.n = s.shading;
  r.diffuse = diffuse.xyz;
  return r;
}

// Reflected radiance from the outline of these corners, for a light of radiance 1.
vec3 reflected_of_polygon(Receiver r, int first, int end, bool two_sided) {
  IrradianceSum edges = no_irradiance();
  vec3 from = texelFetch(polygon_corners, first).xyz - camera_origin;
  for (int i = first + 1; i < end; i++) {
    vec4 corner = texelFetch(polygon_corners, i);
    vec3 to = corner.xyz - camera_origin;
    if (corner.w == 0.0) edges = add_edge_irradiance(edges, from - r.p, to - r.p, to - from, r.n);
    from = to;
  }
  return r.diffuse * (total_irradiance(edges, two_sided) / PI_D);
}
