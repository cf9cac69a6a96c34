// Emission of the primitives that the pixels see, and their unshadowed reflection of all polygon lights, as
// in unshadowed_lights of kernels/light/light_unshadowed.h. With PENUMBRA_PHONG it includes Phong lobes, with
// PENUMBRA_LTC the control lobes of glossy surfaces.
#include "gl/shaders/analytic_camera.glsl"
#include "gl/shaders/analytic_tables.glsl"
#include "gl/shaders/analytic_surface.glsl"
#ifdef PENUMBRA_PHONG
#include "gl/shaders/analytic_phong.glsl"
#else
#include "gl/shaders/analytic_diffuse.glsl"
#endif

#ifdef PENUMBRA_LTC
#define CONTROL_KNOTS 125
#include "gl/shaders/analytic_ltc.glsl"
#endif

uniform isampler2D ids;
uniform samplerBuffer materials;  // diffuse, exponent; specular, lobe
uniform samplerBuffer lights;     // radiance, two_sided
uniform usamplerBuffer polygons;  // radiance, two_sided; first_corner, corner_count, 0, 0
uniform int triangle_count;
uniform int polygon_count;
uniform int environment;  // index of the light, or -1
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
#ifdef PENUMBRA_LTC
  Control control = control_at(s, d);
  diffuse.xyz += control.diffuse;
#endif
  Receiver r = receiver_at(s, d, diffuse, specular);
  vec3 sum = vec3(0.0);
  for (int k = 0; k < polygon_count; k++) {
    // A light does not illuminate itself; in its plane, rounding would decide whether it covers half of the
    // sphere.
    if (k == s.polygon) continue;
    uvec4 shine = texelFetch(polygons, 2 * k), outline = texelFetch(polygons, 2 * k + 1);
    int first = int(outline.x), end = int(outline.x + outline.y);
    sum += uintBitsToFloat(shine.xyz) * reflected_of_polygon(r, first, end, shine.w != 0u);
#ifdef PENUMBRA_LTC
    if (control.leans)
      sum += uintBitsToFloat(shine.xyz) * control.specular *
             lobe_of_polygon(control, s.p, first, end, shine.w != 0u);
#endif
  }
  return sum;
}

// Replaces non-finite values by black.
vec3 finite(vec3 v) {
  return vec3(abs(v.x) < 1e38 ? v.x : 0.0, abs(v.y) < 1e38 ? v.y : 0.0, abs(v.z) < 1e38 ? v.z : 0.0);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 toward = pixel_direction(pixel), d = normalize(toward);
  Surface s = surface_at(texelFetch(ids, pixel, 0).x, triangle_count, near_clip * toward, d);
  bool lit = s.valid && dot(s.shading, d) < 0.0;
  closed_form = vec4(lit ? finite(reflected_radiance(s, d)) : vec3(0.0), 1.0);
  vec3 emitted = finite(emitted_radiance(s));
  emission = vec4(emitted, emitted == vec3(0.0) ? 0.0 : 1.0);
}
