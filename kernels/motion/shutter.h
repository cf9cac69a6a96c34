// The time of a sample while the shutter is open.
#ifndef PENUMBRA_SHUTTER_H
#define PENUMBRA_SHUTTER_H
#include "kernels/sampler/sampler.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

// The time of an image that is frozen, and of light that has no time of its own.
#define MIDDLE_TIME 0.5f

/// A time of a row's exposure, from 0 to 1, in proportion to the shutter's curve. The curve is linear between
/// its knots v, so its integral is quadratic there: v s + (w - v) s^2 / (2 width) = rest.
FN float time_of_exposure(const PRIVATE Scene* scene, float u) {
  const int knots = scene->shutter->curve_knots;
  GLOBAL const float* curve = scene->shutter_curve;
  GLOBAL const float* integral = curve + knots;
  int k = 0;
  while (k < knots - 2 && integral[k + 1] <= u) k++;
  const float width = 1.0f / (float)(knots - 1), v = curve[k], slope = (curve[k + 1] - v) / width;
  const float rest = u - integral[k];
  const float divisor = v + safe_sqrt(v * v + 2.0f * slope * rest);
  const float s = divisor > 0.0f ? 2.0f * rest / divisor : 0.0f;
  return min_f(((float)k + min_f(s / width, 1.0f)) * width, 1.0f);
}

/// The time at which a sample of film row y sees the scene.
FN float time_of_sample(const PRIVATE Scene* scene, int y, float u) {
  GLOBAL const Shutter* shutter = scene->shutter;
  const float later = (float)y / (float)max_i(scene->header.film.height - 1, 1);
  const float time = later * shutter->rolling + time_of_exposure(scene, u) * shutter->exposure;
  return scene->header.adjustable.frozen != 0.0f ? MIDDLE_TIME : clamp_f(time, 0.0f, 1.0f);
}

/// The time of a photon map and of all paths that use it. Maps in a row spread evenly over the exposure:
/// their numbers' radical inverse, shifted by a hash of the seed. `seed`: that of the random sequence.
FN float time_of_map(const PRIVATE Scene* scene, uint seed, uint map) {
  const float u = radical_inverse(map, 2u) + unit_float(hash_uint(seed ^ 0x74696d65u));
  const bool frozen =
      (scene->header.integrator.photons == PHOTONS_FIXED) | (scene->header.adjustable.frozen != 0.0f);
  return frozen ? MIDDLE_TIME : time_of_exposure(scene, min_f(u >= 1.0f ? u - 1.0f : u, ONE_MINUS_EPSILON));
}

/// The times of LANES camera paths from lane i on; `first_sample`: that of their unit, which has one map.
FN void set_sample_times(const PRIVATE Scene* scene, uint first_sample, const PRIVATE PathState* paths,
                         int i) {
  const PRIVATE SceneHeader* h = &scene->header;
  if (NEEDS_PHOTONS(scene)) {
    const uint map = first_sample / (uint)max_i(h->integrator.samples_per_map, 1);
    const float time = time_of_map(scene, h->sampler.seed, map);
    for (int j = i; j < i + LANES; j++) set_time(paths, j, time);
    return;
  }
  float u[LANES], unused[LANES];
  sample_pair(h->sampler.kind, sequence_length(h), one_point(PAIR_TIME), paths, i, u, unused);
  for (int j = 0; j < LANES; j++)
    set_time(paths, i + j, time_of_sample(scene, get_film_y(paths, i + j), u[j]));
}

PENUMBRA_NAMESPACE_END
#endif
