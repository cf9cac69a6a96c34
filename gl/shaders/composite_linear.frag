#version 330 core
// The linear value of a layer, one fragment per film pixel; row 0 is the film's top row, here and in all
// textures. Alpha is 1 if there is a value, else 0.

uniform sampler2D radiance;  // rgb: mean; a: samples
uniform sampler2D difference;
uniform sampler2D standard_error;
uniform sampler2D analytic;  // G
uniform sampler2D emission;  // E, the emission that the camera sees, and the share of the pixel that it covers
uniform int layer;           // enum class Layer
uniform int hybrid;
uniform float alpha;

layout(location = 0) out vec4 value;
layout(location = 1) out vec4 light;  // E and its coverage where they are part of the value

const int COMPOSITE = 0, ANALYTIC = 1, DIFFERENCE = 2, ERROR = 3;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 mean = texelFetch(radiance, pixel, 0);
  bool sampled = mean.a >= 1.0;
  value = light = vec4(0.0);
  if (layer == ERROR) {
    if (mean.a >= 2.0) value = vec4(vec3(texelFetch(standard_error, pixel, 0).r), 1.0);
  } else if (hybrid == 0) {
    if (layer == COMPOSITE && sampled) value = vec4(mean.rgb, 1.0);
  } else {
    vec4 emitted = texelFetch(emission, pixel, 0);
    vec3 g = texelFetch(analytic, pixel, 0).rgb, e = emitted.rgb;
    if (layer == COMPOSITE || layer == ANALYTIC) light = emitted;
    vec3 d = texelFetch(difference, pixel, 0).rgb;
    if (layer == COMPOSITE) value = vec4(sampled ? alpha * g + d + e : g + e, 1.0);
    if (layer == ANALYTIC) value = vec4(g + e, 1.0);
    if (layer == DIFFERENCE && sampled) value = vec4(d, 1.0);
  }
}
