#version 330 core
// From linear values to the screen: a single film pixel if the picture is magnified, else the mean over the
// film pixels below a screen pixel. Formulas: composite_pass.h.

uniform sampler2D linear_values;  // from composite_linear.frag
uniform sampler2D radiance;  // for relative standard errors
uniform sampler2D heat;           // linear RGB over [0, 1]
uniform vec2 origin;  // the picture's upper left corner, pixels from the target's lower left
uniform vec2 film_per_pixel;  // film pixels per screen pixel
uniform int layer;                // enum class Layer
uniform int tone_map;             // enum class ToneMap
uniform float gain;               // 2^exposure
uniform int relative_error;
uniform vec2 error_range;  // log10 of the darkest and the brightest value
uniform float check_size;         // pixels

out vec4 colour;

const int DIFFERENCE = 2, ERROR = 3;
const int REINHARD = 1, FILMIC = 2;
const float HUGE = 1e15;  // bright enough for a display, and its square is finite

// By bits: compilers may assume that isnan() is false.
bool is_finite(float x) { return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u; }
bool are_finite(vec3 v) { return is_finite(v.x) && is_finite(v.y) && is_finite(v.z); }

vec3 srgb_from_linear(vec3 v) {
  v = clamp(v, 0.0, 1.0);
  return mix(1.055 * pow(v, vec3(1.0 / 2.4)) - 0.055, 12.92 * v, vec3(lessThanEqual(v, vec3(0.0031308))));
}

vec3 tone_mapped(vec3 v) {
  v = clamp(v, 0.0, HUGE);
  if (tone_map == REINHARD) return v / (1.0 + dot(v, vec3(0.2126, 0.7152, 0.0722)));
  if (tone_map == FILMIC) return v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14);
  return v;
}

float root_mean_square(vec3 v) {
  float largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
  return largest > 0.0 ? largest * length(v / largest) / sqrt(3.0) : 0.0;
}

vec3 heat_of(float error, float level) {
  float x = error;
  if (relative_error != 0) x = level > 0.0 ? error / level : (error > 0.0 ? HUGE : 0.0);
  float t = x > 0.0 ? (log(x) / log(10.0) - error_range.x) / (error_range.y - error_range.x) : 0.0;
  // 0 is the centre of the first entry, 1 that of the last one.
  float entries = float(textureSize(heat, 0).x);
  return texture(heat, vec2((clamp(t, 0.0, 1.0) * (entries - 1.0) + 0.5) / entries, 0.5)).rgb;
}

void main() {
  vec2 pixel = vec2(gl_FragCoord.x - origin.x, origin.y - gl_FragCoord.y);  // in the picture, at the pixel's centre
  ivec2 film = textureSize(linear_values, 0);
  vec2 low = (pixel - 0.5) * film_per_pixel, high = (pixel + 0.5) * film_per_pixel;
  ivec2 first = ivec2(floor(low)), last = ivec2(ceil(high)) - 1;
  if (film_per_pixel.x <= 1.0) first.x = last.x = int(floor(pixel.x * film_per_pixel.x));
  if (film_per_pixel.y <= 1.0) first.y = last.y = int(floor(pixel.y * film_per_pixel.y));
  first = clamp(first, ivec2(0), film - 1);
  last = clamp(last, first, film - 1);

  vec4 sum = vec4(0.0);
  float level = 0.0;
  bool finite = true;
  for (int y = first.y; y <= last.y; ++y) {
    float height = first.y == last.y ? 1.0 : min(float(y) + 1.0, high.y) - max(float(y), low.y);
    for (int x = first.x; x <= last.x; ++x) {
      float weight = height * (first.x == last.x ? 1.0 : min(float(x) + 1.0, high.x) - max(float(x), low.x));
      vec4 value = texelFetch(linear_values, ivec2(x, y), 0);
      if (value.a == 0.0 || weight <= 0.0) continue;
      finite = finite && are_finite(value.rgb);
      sum += weight * vec4(value.rgb, 1.0);
      if (layer == ERROR) level += weight * root_mean_square(texelFetch(radiance, ivec2(x, y), 0).rgb);
    }
  }

  if (!finite) {
    colour = vec4(1.0, 0.0, 1.0, 1.0);
    return;
  }
  if (sum.a == 0.0) {
    vec2 check = floor(pixel / check_size);
    colour = vec4(vec3(mod(check.x + check.y, 2.0) == 0.0 ? 0.11 : 0.15), 1.0);
    return;
  }
  vec3 mean = sum.rgb / sum.a;
  if (layer == DIFFERENCE) {
    colour = vec4(0.5 + 0.5 * sign(mean) * srgb_from_linear(abs(mean) * gain), 1.0);
  } else if (layer == ERROR) {
    colour = vec4(srgb_from_linear(heat_of(mean.r, level / sum.a)), 1.0);
  } else {
    colour = vec4(srgb_from_linear(tone_mapped(mean * gain)), 1.0);
  }
}
