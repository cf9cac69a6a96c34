// Reflection of polygon lights by the control lobes of glossy surfaces: kernels/bsdf/control_lobes.h, as
// curves over the cosine of wo for each material (scenes/device/ltc/control_knots.h).
#include "kernels/bsdf/ltc.h"

uniform samplerBuffer control_lobes;  // for each knot: diffuse, lean; specular, width_x; width_y, 0, 0, 0

struct Control {
  vec3 diffuse, specular;
  bool leans;
  vec3 x, y, z;  // axes of the cosine's space
};

Control control_at(Surface s, vec3 d) {
  float cosine = clamp(-dot(s.shading, d), 0.0, 1.0), column = sqrt(cosine) * float(CONTROL_KNOTS - 1);
  int knot = min(int(column), CONTROL_KNOTS - 2), first = 3 * (s.material * CONTROL_KNOTS + knot);
  float t = column - float(knot);
  vec4 a0 = texelFetch(control_lobes, first), a1 = texelFetch(control_lobes, first + 3);
  vec4 b0 = texelFetch(control_lobes, first + 1), b1 = texelFetch(control_lobes, first + 4);
  // Matrices are linear in the root of the cosine, colours nearly linear in the cosine.
  float low = float(knot) / float(CONTROL_KNOTS - 1), high = float(knot + 1) / float(CONTROL_KNOTS - 1);
  float share = clamp((cosine - low * low) / (high * high - low * low), 0.0, 1.0);
  float width_y = mix(texelFetch(control_lobes, first + 2).x, texelFetch(control_lobes, first + 5).x, t);
  Control c;
  c.diffuse = mix(a0.xyz, a1.xyz, share);
  c.specular = mix(b0.xyz, b1.xyz, share);
  c.leans = b0.w > 0.0;
  float width_x = mix(b0.w, b1.w, t);
  Ltc ltc = make_ltc(mix(a0.w, a1.w, t), c.leans ? width_x : 1.0, c.leans ? width_y : 1.0, 0.5, cosine);
  vec3 along = d + cosine * s.shading, axis = vec3(1.0, 0.0, 0.0);
  if (abs(s.shading.x) > 0.9) axis = vec3(0.0, 1.0, 0.0);
  // A lobe about the normal is round: any axis will do.
  vec3 tangent = dot(along, along) > 1e-12 ? along : cross(s.shading, axis);
  tangent = normalize(tangent - dot(tangent, s.shading) * s.shading);
  c.x = (tangent - ltc.shift * s.shading) / ltc.width_x;
  c.y = cross(s.shading, tangent) / ltc.width_y;
  c.z = s.shading;
  return c;
}

vec3 to_control_space(Control c, vec3 v) {
  return vec3(dot(c.x, v), dot(c.y, v), dot(c.z, v));
}

// The lobe's reflection for reflectance 1 of a light of radiance 1 with the outline of these corners, at p.
float lobe_of_polygon(Control c, vec3 p, int first, int end, bool two_sided) {
  IrradianceSum edges = no_irradiance();
  vec3 from = texelFetch(polygon_corners, first).xyz - camera_origin;
  for (int i = first + 1; i < end; i++) {
    vec4 corner = texelFetch(polygon_corners, i);
    vec3 to = corner.xyz - camera_origin;
    if (corner.w == 0.0)
      edges = add_edge_irradiance(edges, to_control_space(c, from - p), to_control_space(c, to - p),
                                  to_control_space(c, to - from), vec3(0.0, 0.0, 1.0));
    from = to;
  }
  return total_irradiance(edges, two_sided) / PI_D;
}
