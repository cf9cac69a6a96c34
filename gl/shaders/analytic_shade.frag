// What the primitives that the pixels see emit, and what they reflect of all polygon lights without shadows, as
// survey_lights of kernels/light_survey.h says. With PENUMBRA_PHONG lobes are counted too.
#include "kernels/polygon_edge.h"
#include "gl/shaders/analytic_camera.glsl"
#include "gl/shaders/analytic_tables.glsl"
#include "gl/shaders/analytic_surface.glsl"
#ifdef PENUMBRA_PHONG
#include "gl/shaders/analytic_lobe.glsl"
#endif

uniform isampler2D ids;
uniform samplerBuffer materials;        // diffuse, exponent; specular, lobe
uniform samplerBuffer lights;           // radiance, two_sided
uniform usamplerBuffer polygons;        // radiance, two_sided; first_corner, corner_count, 0, 0
uniform samplerBuffer polygon_corners;  // p, starts
uniform int triangle_count;
uniform int polygon_count;
uniform int environment;  // light, or -1
uniform bool hide_emitters;

layout(location = 0) out vec4 closed_form;
layout(location = 1) out vec4 emission;

vec3 emitted_radiance(Surface s) {
  if (hide_emitters) return vec3(0.0);
  if (!s.valid) return environment >= 0 ? texelFetch(lights, environment).xyz : vec3(0.0);
  if (s.light < 0) return vec3(0.0);
  vec4 light = texelFetch(lights, s.light);
  return (s.front || light.w != 0.0) ? light.xyz : vec3(0.0);
}

vec3 reflected_radiance(Surface s, vec3 d) {
  vec4 diffuse = texelFetch(materials, 2 * s.material), specular = texelFetch(materials, 2 * s.material + 1);
  vec3 sum = vec3(0.0);
  vec3 n = s.shading;
#ifdef PENUMBRA_PHONG
  bool glossy = specular.w > 0.0;
  Lobe lobe = start_lobe(n, normalize(d - 2.0 * dot(n, d) * n), glossy ? diffuse.w : 0.0);
#endif
  for (int k = 0; k < polygon_count; k++) {
    // A light does not shine on itself; in its plane rounding would say whether it covers half the sphere.
    if (k == s.polygon) continue;
    uvec4 shine = texelFetch(polygons, 2 * k), outline = texelFetch(polygons, 2 * k + 1);
    int first = int(outline.x), end = int(outline.x + outline.y);
    IrradianceSum edges = no_irradiance();
#ifdef PENUMBRA_PHONG
    LobeSum arcs;
    arcs.sum = arcs.open = 0.0;
    arcs.a = vec3(0.0);
#endif
    vec3 from = texelFetch(polygon_corners, first).xyz;
    for (int i = first + 1; i < end; i++) {
      vec4 corner = texelFetch(polygon_corners, i);
      if (corner.w == 0.0) {
        VisibleEdge e = visible_edge(from - s.p, corner.xyz - s.p, corner.xyz - from, n);
        float angle = atan2_d(e.sine, e.cosine);
        edges = add_irradiance(edges, e, angle, n);
#ifdef PENUMBRA_PHONG
        if (glossy) arcs = add_lobe(arcs, lobe, e, angle);
#endif
      }
      from = corner.xyz;
    }
    bool two_sided = shine.w != 0u;
    vec3 reflected = diffuse.xyz * (total_irradiance(edges, two_sided) / PI_D);
#ifdef PENUMBRA_PHONG
    float total = -0.5 / PI_D * arcs.sum;
    reflected += specular.xyz * max(two_sided ? abs(total) : total, 0.0);
#endif
    sum += uintBitsToFloat(shine.xyz) * reflected;
  }
  return sum;
}

// What is not finite counts as black.
vec3 finite(vec3 v) {
  return vec3(abs(v.x) < 1e38 ? v.x : 0.0, abs(v.y) < 1e38 ? v.y : 0.0, abs(v.z) < 1e38 ? v.z : 0.0);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 toward = pixel_direction(pixel), d = normalize(toward);
  Surface s = surface_at(texelFetch(ids, pixel, 0).x, triangle_count, camera_origin + near_clip * toward, d);
  bool lit = s.valid && dot(s.shading, d) < 0.0;
  closed_form = vec4(lit ? finite(reflected_radiance(s, d)) : vec3(0.0), 1.0);
  emission = vec4(finite(emitted_radiance(s)), 1.0);
}
