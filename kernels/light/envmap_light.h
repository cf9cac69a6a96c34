// Environments: a constant one, and a map. The radiance of the map is bilinear over the grid of
// envmap_grid.h. Directions are sampled exactly from a pdf that is bilinear over the grid, too.
//
// Tables: the texels, row by row. envmap_columns: for each row y and column x, the cumulative sum of the
// row's weights (interpolated between columns) up to x; W + 1 sums per row, from 0 on, with the levels of
// sum_search.h. envmap_rows: the total, the sums of all rows and, from envmap_shares on, the cumulative
// shares of the rows in the total (H numbers from 0 to 1, with levels).
#ifndef PENUMBRA_ENVMAP_LIGHT_H
#define PENUMBRA_ENVMAP_LIGHT_H
#include "kernels/light/envmap_grid.h"
#include "kernels/light/kind_functions.h"
#include "kernels/light/light_found.h"
#include "kernels/light/sum_search.h"
#include "kernels/math/frame.h"

PENUMBRA_NAMESPACE_BEGIN

LIGHT_EMITS_UNIFORMLY(environment)

FN LightSample sample_environment_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                        LightReceiver r, float u, float v, LightSampling sampling,
                                        ulong strategies) {
  LightSample s = toward_infinity(r, sample_uniform_sphere(u, v));
  s.pdf = 0.25f * INV_PI_F;
  s.radiance = environment_light_radiance(scene, light, light_point(s.origin, negate(s.wi)), s.wi);
  return s;
}

FN float environment_light_pdf(const PRIVATE Scene* scene, Light light, FoundLight found, ulong strategies) {
  return 0.25f * INV_PI_F;
}

/// The cell that contains a point of the grid, and the position in it.
typedef struct {
  int x, next_x, y;
  float s, t;
} EnvmapPoint;

FN EnvmapPoint envmap_point(EnvironmentMap map, float x, float y) {
  EnvmapPoint p;
  const int column = (int)x, row = (int)y;
  p.x = column < map.width - 1 ? column : map.width - 1;
  p.next_x = p.x + 1 < map.width ? p.x + 1 : 0;
  p.y = row < map.height - 2 ? row : map.height - 2;
  p.s = x - (float)p.x;
  p.t = y - (float)p.y;
  return p;
}

/// The grid point of the unit direction, and the sine of its angle to the axis.
FN EnvmapPoint envmap_at(Light light, EnvironmentMap map, vec3 wi, PRIVATE float* sine) {
  const float x = dot3(light.p0, wi), y = dot3(light.p1, wi), z = dot3(light.p2, wi);
  const float turns = atan2_f(x, -z) * (0.5f * INV_PI_F);
  const float u = turns < 0.0f ? turns + 1.0f : turns;
  const float column = u * (float)map.width - 0.5f;
  *sine = SQRT(sqr(x) + sqr(z));
  const float angle = atan2_f(*sine, y) * INV_PI_F;
  return envmap_point(map, column < 0.0f ? column + (float)map.width : column,
                      clamp_f(angle, 0.0f, 1.0f) * (float)(map.height - 1));
}

/// The direction of a grid point, and the sine of its angle to the axis.
FN vec3 envmap_direction(Light light, EnvironmentMap map, float x, float y, PRIVATE float* sine) {
  float sine_u, cosine_u, cosine;
  sincos_2pi((x + 0.5f) / (float)map.width, &sine_u, &cosine_u);
  sincos_2pi(0.5f * y / (float)(map.height - 1), sine, &cosine);
  const vec3 along_x = scale(light.p0, sine_u * *sine), along_y = scale(light.p1, cosine);
  return add(add(along_x, along_y), scale(light.p2, -cosine_u * *sine));
}

FN vec3 envmap_texel(const PRIVATE Scene* scene, EnvironmentMap map, int x, int y) {
  return load3(scene->envmap_texels + y * map.width + x);
}

FN vec3 envmap_radiance(const PRIVATE Scene* scene, EnvironmentMap map, EnvmapPoint p) {
  const vec3 a = envmap_texel(scene, map, p.x, p.y), b = envmap_texel(scene, map, p.next_x, p.y);
  const vec3 c = envmap_texel(scene, map, p.x, p.y + 1), d = envmap_texel(scene, map, p.next_x, p.y + 1);
  return mix3(mix3(a, b, p.s), mix3(c, d, p.s), p.t);
}

/// The weight at column x, interpolated between the rows of p.
FN float envmap_column_weight(const PRIVATE Scene* scene, EnvironmentMap map, EnvmapPoint p, int x) {
  const vec3 above = envmap_texel(scene, map, x, p.y), below = envmap_texel(scene, map, x, p.y + 1);
  return mix_f(envmap_weight(above, envmap_row_sine(p.y, map.height), map.covered),
               envmap_weight(below, envmap_row_sine(p.y + 1, map.height), map.covered), p.t);
}

/// Pdf per solid angle at a point of this weight.
FN float envmap_density(const PRIVATE Scene* scene, EnvironmentMap map, float weight, float sine) {
  const float whole = scene->envmap_rows[0];
  const float cells = (float)map.width * (float)(map.height - 1);
  const float area = (2.0f * PI_F * PI_F) * max_f(sine, 1e-12f);
  return whole > 0.0f ? weight / whole * (cells / area) : 0.0f;
}

FN vec3 envmap_light_radiance(const PRIVATE Scene* scene, Light light, LightPoint at, vec3 wi) {
  const EnvironmentMap map = scene->envmaps[0];
  float sine;
  return envmap_radiance(scene, map, envmap_at(light, map, wi, &sine));
}

/// Samples a linear density on [0, 1] from a to b, both >= 0: the point below which lies the fraction u.
FN float sample_linear(float u, float a, float b) {
  const float root = SQRT(mix_f(sqr(a), sqr(b), u));
  const float sum = a + root;
  return min_f(sum > 0.0f ? u * (a + b) / sum : u, ONE_MINUS_EPSILON);
}

/// The sums of two neighbouring rows.
typedef struct {
  float first, second;
} EnvmapRowSums;

FN EnvmapRowSums envmap_row_sums(const PRIVATE Scene* scene, int y) {
  GLOBAL const float* sums = scene->envmap_rows + 1;
  EnvmapRowSums two;
  two.first = sums[y];
  two.second = sums[y + 1];
  return two;
}

/// Samples the position between row y and the next one by v, and scales u to the sum of weights there.
STAGE void choose_between_envmap_rows(const PRIVATE Scene* scene, const PRIVATE float* RESTRICT u,
                                      const PRIVATE float* RESTRICT v,
                                      PRIVATE LightSamplings* RESTRICT samplings,
                                      PRIVATE float* RESTRICT targets, PRIVATE int* RESTRICT rows) {
  const EnvironmentMap map = scene->envmaps[0];
  const int stride = search_size(map.width + 1);
  GLOBAL const float* shares = scene->envmap_rows + envmap_shares(map.height);
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int y = samplings->row[j];
      const float below = shares[y], share = shares[y + 1] - below;
      const float left = share > 0.0f ? (v[j] - below) / share : 0.5f;
      const EnvmapRowSums sums = envmap_row_sums(scene, y);
      const float t = sample_linear(clamp_f(left, 0.0f, ONE_MINUS_EPSILON), sums.first, sums.second);
      samplings->between[j] = t;
      targets[j] = u[j] * mix_f(sums.first, sums.second, t);
      rows[j] = y * stride;
    }
}

/// Samples cells of the grid by u and v, in the lanes whose light is the environment map.
FN void choose_envmap_cells(const PRIVATE Scene* scene, const PRIVATE int* kinds, const PRIVATE float* u,
                            const PRIVATE float* v, PRIVATE LightSamplings* samplings) {
  const EnvironmentMap map = scene->envmaps[0];
  int wanted[LANES], rows[LANES];
  float between[LANES], targets[LANES];
  for (int j = 0; j < LANES; j++) {
    wanted[j] = kinds[j] == LIGHT_ENVMAP ? 1 : 0;
    rows[j] = envmap_shares(map.height);
    between[j] = 0.0f;
  }
  search_sums(scene->envmap_rows, search_levels(map.height), 0, map.height - 2, wanted, rows, between, v,
              samplings->row);
  choose_between_envmap_rows(scene, u, v, samplings, targets, rows);
  const SearchLevels levels = search_levels(map.width + 1);
  search_sums(scene->envmap_columns, levels, levels.size, map.width - 1, wanted, rows, samplings->between,
              targets, samplings->column);
}

FN LightSample sample_envmap_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                   LightReceiver r, float u, float v, LightSampling sampling,
                                   ulong strategies) {
  const EnvironmentMap map = scene->envmaps[0];
  const int x = sampling.column, y = sampling.row;
  const float t = sampling.between;
  const int stride = search_size(map.width + 1);
  GLOBAL const float* columns = scene->envmap_columns + y * stride;
  const EnvmapRowSums sums = envmap_row_sums(scene, y);
  const float target = u * mix_f(sums.first, sums.second, t);
  EnvmapPoint p = envmap_point(map, (float)x, (float)y);
  p.t = t;
  const float a = envmap_column_weight(scene, map, p, p.x), b = envmap_column_weight(scene, map, p, p.next_x);
  const float below = mix_f(columns[x], columns[stride + x], t);
  const float cell = mix_f(columns[x + 1], columns[stride + x + 1], t) - below;
  p.s = sample_linear(clamp_f(cell > 0.0f ? (target - below) / cell : 0.5f, 0.0f, ONE_MINUS_EPSILON), a, b);
  float sine;
  LightSample s = toward_infinity(r, envmap_direction(light, map, (float)p.x + p.s, (float)p.y + p.t, &sine));
  s.pdf = envmap_density(scene, map, mix_f(a, b, p.s), sine);
  s.radiance = envmap_radiance(scene, map, p);
  return s;
}

FN float envmap_light_pdf(const PRIVATE Scene* scene, Light light, FoundLight found, ulong strategies) {
  const EnvironmentMap map = scene->envmaps[0];
  float sine;
  const EnvmapPoint p = envmap_at(light, map, found.wi, &sine);
  const float a = envmap_column_weight(scene, map, p, p.x), b = envmap_column_weight(scene, map, p, p.next_x);
  return envmap_density(scene, map, mix_f(a, b, p.s), sine);
}

PENUMBRA_NAMESPACE_END
#endif
