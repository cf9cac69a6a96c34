// Media that emit, as lights: each samples a point of its grid, in proportion to the power that blocks of
// cells emit. Emission that is the same everywhere has a grid around the medium's shapes. Rays find the same
// light on their way through the medium (kernels/medium/emission.h). Both estimate the light that leaves a
// point y towards a receiver x, and their weights add up to 1 for each pair of points: a balance of the
// density of the direction at x and of r^2 / area, where r is their distance and `area` about the medium's
// section. So the inverse square law is bounded in samples of points, and what rays find far away has little
// weight.
#ifndef PENUMBRA_MEDIUM_LIGHT_H
#define PENUMBRA_MEDIUM_LIGHT_H
#include "kernels/light/delta_lights.h"
#include "kernels/medium/emission.h"

PENUMBRA_NAMESPACE_BEGIN

/// The glow of a light; of other lights an arbitrary one.
FN GLOBAL const Glow* glow_of(const PRIVATE Scene* scene, int light) {
  const int glow = scene->lights[light].beam;
  const bool has_glow =
      (scene->lights[light].kind == LIGHT_MEDIUM) & (glow >= 0) & (glow < scene->header.tables.glows.count);
  return scene->glows + (has_glow ? glow : 0);
}

/// The block of the glow that u, in [0, 1), chooses.
FN int glow_block(const PRIVATE Scene* scene, GLOBAL const Glow* glow, float u) {
  int first = glow->first_block;
  for (int size = glow->blocks; size > 1;) {
    const int half_size = size >> 1;
    const bool above = scene->glow_blocks[first + half_size].below <= u;
    first = above ? first + half_size : first;
    size = above ? size - half_size : half_size;
  }
  return first;
}

/// Chooses a point of the light's medium by u and v: `wi` becomes its position, `between` the factor from
/// the emission there to the sample's radiance, see sample_medium_light.
FN LightSampling sample_glow(const PRIVATE Scene* scene, int light, float u, float v,
                             LightSampling sampling) {
  GLOBAL const Glow* glow = glow_of(scene, light);
  GLOBAL const Volume* volume = scene->volumes + glow->volume;
  const int block = glow_block(scene, glow, u), last = glow->first_block + glow->blocks - 1;
  GLOBAL const GlowBlock* chosen = scene->glow_blocks + block;
  const float share = (block < last ? chosen[1].below : 1.0f) - chosen->below;
  const int x = chosen->x * glow->side, y = chosen->y * glow->side, z = chosen->z * glow->side;
  const float width = (float)min_i(glow->side, volume->nx - x),
              height = (float)min_i(glow->side, volume->ny - y),
              depth = (float)min_i(glow->side, volume->nz - z);
  // Two pairs of numbers are not enough for a block and a point in it: the other coordinates are hashes.
  const uint digits = hash_uint(FLOAT_BITS(u) ^ hash_uint(FLOAT_BITS(v)));
  const float in_x = (float)x + width * v, in_y = (float)y + height * unit_float(digits),
              in_z = (float)z + depth * unit_float(hash_uint(digits + 0x9e3779b9u));
  const vec3 along_x = scale(load3(&glow->cell_x), in_x), along_y = scale(load3(&glow->cell_y), in_y);
  sampling.wi = add(load3(&volume->corner), add(add(along_x, along_y), scale(load3(&glow->cell_z), in_z)));
  sampling.between = width * height * depth * glow->by_area / share;
  return sampling;
}

/// The emission at the sampled point.
FN vec3 glow_emission(const PRIVATE Scene* scene, int light, LightSampling sampling) {
  return emission_at(scene, scene->media + glow_of(scene, light)->medium, sampling.wi);
}

/// The radiance without the emission, by which medium_light_colours multiplies it. Radiance over pdf is the
/// emission over the density of the point per volume and r^2; the pdf is not that of the direction, but what
/// is weighed against it. The weight is applied where the BSDF is known, hence `delta`.
FN LightSample sample_medium_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                   LightReceiver r, float u, float v, LightSampling sampling,
                                   ulong strategies) {
  float d2;
  LightSample s = toward_point(r, sampling.wi, &d2);
  s.pdf = d2 / light.area;
  s.delta = true;
  s.radiance = make_vec3(sampling.between, sampling.between, sampling.between);
  return s;
}

NO_RAY_FINDS_BEAM(medium)

/// Chooses points in the lanes whose light is a medium.
FN void choose_glow_points(const PRIVATE Scene* scene, const PRIVATE int* lights, const PRIVATE int* kinds,
                           const PRIVATE float* u, const PRIVATE float* v,
                           PRIVATE LightSamplings* samplings) {
  for (int j = 0; j < LANES; j++)  // no lane loop: few scenes have such lights
    if (kinds[j] == LIGHT_MEDIUM)
      store_light_sampling(samplings, j,
                           sample_glow(scene, lights[j], u[j], v[j], load_light_sampling(samplings, j)));
}

/// Multiplies the radiance of those samples by the emission at their points.
FN void colour_glow_samples(const PRIVATE Scene* scene, const PRIVATE int* lights, const PRIVATE int* kinds,
                            const PRIVATE LightSamplings* samplings, PRIVATE LightSamples* samples) {
  for (int j = 0; j < LANES; j++) {
    if (kinds[j] != LIGHT_MEDIUM || !(samples->tmax[j] > 0.0f)) continue;
    const vec3 emission = glow_emission(scene, lights[j], load_light_sampling(samplings, j));
    STORE_LANE_vec3(samples->radiance, j, mul(LOAD_LANE_vec3(samples->radiance, j), emission));
    samples->tmax[j] = max_component(emission) > 0.0f ? samples->tmax[j] : -1.0f;
  }
}

PENUMBRA_NAMESPACE_END
#endif
