#version 330 core
// From linear values to the screen: a single film pixel if the picture is magnified, else the mean over the
// film pixels below a screen pixel. Formulas: composite_pass.h.

uniform sampler2D linear_values;  // from composite_linear.frag
uniform sampler2D lights;         // likewise: emission that the camera sees, and its coverage of the pixel
uniform sampler2D radiance;       // for relative standard errors
uniform sampler2D heat;           // linear RGB over [0, 1]
uniform vec2 origin;  // the picture's upper left corner, pixels from the target's lower left
uniform vec2 film_per_pixel;  // film pixels per screen pixel
uniform int display;              // enum class Display
uniform int tone_map;             // enum class ToneOperator
uniform float gain;               // 2^exposure
uniform int over_brightness;
uniform vec2 heat_range;          // log10 of the darkest and the brightest value
uniform float check_size;         // pixels

out vec4 colour;

const int SIGNED = 1, HEAT = 2, NORMAL = 3, IDENTITY = 4;
const int REINHARD = 1, FILMIC = 2, ACES = 3;
const float HUGE = 1e15;  // bright enough for a display, and its square is finite

// By bits: compilers may assume that isnan() is false.
bool is_finite(float x) { return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u; }
bool are_finite(vec3 v) { return is_finite(v.x) && is_finite(v.y) && is_finite(v.z); }

vec3 srgb_from_linear(vec3 v) {
  v = clamp(v, 0.0, 1.0);
  return mix(1.055 * pow(v, vec3(1.0 / 2.4)) - 0.055, 12.92 * v, vec3(lessThanEqual(v, vec3(0.0031308))));
}

float luminance(vec3 v) { return dot(v, vec3(0.2126, 0.7152, 0.0722)); }

vec3 hable_curve(vec3 x) {
  return (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3;
}

// Of scheduler/image/tone_map.h.
vec3 tone_mapped(vec3 v) {
  v = clamp(v, 0.0, HUGE);
  if (tone_map == REINHARD) return min(v / (1.0 + luminance(v)), 1.0);
  if (tone_map == FILMIC) return min(hable_curve(2.0 * v) / hable_curve(vec3(11.2)), 1.0);
  if (tone_map == ACES) return min(v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14), 1.0);
  return min(v, 1.0);
}

// A pixel that a light covers in part shows the mean of both parts' tone maps: the tone map of their mean would be as
// bright as the light itself.
vec3 shown_light(vec3 mean, vec4 light) {
  float covered = clamp(light.a, 0.0, 1.0);
  if (covered <= 0.0 || covered >= 1.0) return tone_mapped(mean * gain);
  return mix(tone_mapped((mean - light.rgb) / (1.0 - covered) * gain), tone_mapped(light.rgb / covered * gain), covered);
}

// Neighbouring numbers get different colours of like lightness.
vec3 colour_of_identity(float value) {
  uint bits = floatBitsToUint(value);
  if (bits == 0u) return vec3(0.07);
  bits = (bits ^ (bits >> 16)) * 0x7feb352du;
  bits = (bits ^ (bits >> 15)) * 0x846ca68bu;
  bits ^= bits >> 16;
  float hue = 6.0 * float(bits & 0xffffu) / 65536.0, strength = 0.45 + 0.4 * float((bits >> 16) & 0xffu) / 255.0;
  vec3 pure = clamp(abs(mod(hue + vec3(0.0, 4.0, 2.0), 6.0) - 3.0) - 1.0, 0.0, 1.0);
  return mix(vec3(0.75), 0.35 + 0.6 * pure, strength);
}

float root_mean_square(vec3 v) {
  float largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
  return largest > 0.0 ? largest * length(v / largest) / sqrt(3.0) : 0.0;
}

vec3 heat_of(float value, float level) {
  float x = value;
  if (over_brightness != 0) x = level > 0.0 ? value / level : (value > 0.0 ? HUGE : 0.0);
  float t = x > 0.0 ? (log(x) / log(10.0) - heat_range.x) / (heat_range.y - heat_range.x) : 0.0;
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

  if (display == IDENTITY) {
    vec4 value = texelFetch(linear_values, clamp(ivec2(floor(pixel * film_per_pixel)), ivec2(0), film - 1), 0);
    if (value.a != 0.0) {
      colour = vec4(colour_of_identity(value.r), 1.0);
      return;
    }
  }

  vec4 sum = vec4(0.0), light = vec4(0.0);
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
      light += weight * texelFetch(lights, ivec2(x, y), 0);
      if (over_brightness != 0) level += weight * root_mean_square(texelFetch(radiance, ivec2(x, y), 0).rgb);
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
  if (display == SIGNED) {
    colour = vec4(0.5 + 0.5 * sign(mean) * srgb_from_linear(abs(mean) * gain), 1.0);
  } else if (display == HEAT) {
    colour = vec4(srgb_from_linear(heat_of(luminance(mean), level / sum.a)), 1.0);
  } else if (display == NORMAL) {
    colour = vec4(0.5 + 0.5 * clamp(mean, -1.0, 1.0), 1.0);
  } else {
    colour = vec4(srgb_from_linear(shown_light(mean, light / sum.a)), 1.0);
  }
}
