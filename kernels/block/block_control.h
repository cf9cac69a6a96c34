// From the samples of polygon lights, with and without shadows, and their closed form to the samples of a
// pixel: see ESTIMATOR_*.
#ifndef PENUMBRA_BLOCK_CONTROL_H
#define PENUMBRA_BLOCK_CONTROL_H
#include "kernels/block/block_accumulate.h"
#include "kernels/integrator/control_variate.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

#if HAS(POLYGONS)
/// A sample of which any part is not finite becomes one NaN or infinity of its plain part, for accumulate()
/// to count.
FN void check_control(const PRIVATE SlotState* slots, int s) {
  const vec3 plain = get_slot_sample(slots, s), shadowed = get_slot_shadowed(slots, s);
  const vec3 unshadowed = get_slot_unshadowed(slots, s), analytic = get_slot_analytic(slots, s);
  const vec3 sum = add(add(add(plain, shadowed), unshadowed), analytic), zero = make_vec3(0.0f, 0.0f, 0.0f);
  const uint bits = FLOAT_BITS((sum.x + sum.y) + sum.z);
  const bool finite = !(is_nan_bits(bits) | is_infinite_bits(bits));
  set_slot_sample(slots, s, select3(finite, plain, sum));
  set_slot_shadowed(slots, s, select3(finite, shadowed, zero));
  set_slot_unshadowed(slots, s, select3(finite, unshadowed, zero));
  set_slot_analytic(slots, s, select3(finite, analytic, zero));
}

  #if HAS(RATIO)
/// For the ratio estimator: mean and deviation of what the ratio multiplies, and its correlation with the
/// rest, after accumulate().
STAGE void accumulate_ratio(const PRIVATE Unit* unit, int first_pixel, int pixels,
                            const PRIVATE SlotState* slots, uint features, GLOBAL float* RESTRICT out) {
  const int n = unit->sample_count, area = unit->width * unit->height;
  const int pitch = slot_pixels(slots->capacity, n, LANES);
  for (int c = 0; c < 3; c++) {
    const GLOBAL float* a = slots->sample + c * slots->capacity;
    const GLOBAL float* b = slots->unshadowed + c * slots->capacity;
    GLOBAL float* estimate = out + c * area + first_pixel;  // mean, and three planes on the deviation
    GLOBAL float* planes = out + (first_ratio_plane(features) + c) * area + first_pixel;
    accumulate_field(b, pitch, pixels, n, planes + RATIO_MEAN_PLANE * area,
                     planes + RATIO_DEVIATION_PLANE * area);
    for (int p = 0; p < pixels; p++) {
      const float mean_a = estimate[p], mean_b = planes[RATIO_MEAN_PLANE * area + p];
      const float deviation_a = estimate[3 * area + p],
                  deviation_b = planes[RATIO_DEVIATION_PLANE * area + p];
      const bool varies = (deviation_a > 0.0f) & (deviation_b > 0.0f);
      const float unit_a = varies ? deviation_a : 1.0f, unit_b = varies ? deviation_b : 1.0f;
      float products = 0.0f;
      for (int s = 0; s < n; s++)
        products += ((a[s * pitch + p] - mean_a) / unit_a) * ((b[s * pitch + p] - mean_b) / unit_b);
      planes[RATIO_CORRELATION_PLANE * area + p] = varies ? clamp_f(products / (float)n, -1.0f, 1.0f) : 0.0f;
    }
  }
}
  #endif

/// Completes the samples of the block's pixels by their control variates. For the ratio estimator, whose
/// ratio the film corrects once it has those of other units, leaves in UNSHADOWED what the ratio multiplies.
/// With `layers` also the means of the closed form G, of what shadows take away (the samples' part of the
/// estimate less G), and of the light samples with and without shadows, in the planes after the other
/// layers'.
STAGE void control_samples(const PRIVATE Scene* scene, const PRIVATE Unit* unit, int first_pixel, int pixels,
                           const PRIVATE SlotState* slots, bool layers, GLOBAL float* RESTRICT out) {
  const int n = unit->sample_count, area = unit->width * unit->height;
  const int estimator = scene->header.integrator.estimator, pitch = slot_pixels(slots->capacity, n, LANES);
  for (int p = 0; p < pixels; p++)
    for (int s = 0; s < n; s++) check_control(slots, s * pitch + p);
  const bool ratio = HAS(RATIO) && estimator == ESTIMATOR_RATIO;
  GLOBAL float* ratio_out = out + first_ratio_plane(SCENE_FEATURES(&scene->header)) * area + first_pixel;
  for (int c = 0; c < 3 && ratio; c++)
    accumulate_field(slots->unshadowed + c * slots->capacity, pitch, pixels, n,
                     ratio_out + (RATIO_UNSHADOWED_PLANE + c) * area, 0);
  for (int p = 0; p < pixels; p++) {
    float all_shadowed = 0.0f, all_unshadowed = 0.0f;
    for (int c = 0; c < 3; c++) {
      GLOBAL float* sample = slots->sample + c * slots->capacity + p;
      GLOBAL float* shadowed = slots->shadowed + c * slots->capacity + p;
      GLOBAL float* unshadowed = slots->unshadowed + c * slots->capacity + p;
      GLOBAL float* analytic = slots->analytic + c * slots->capacity + p;
      const int parity = (int)(unit->first_sample & 1u);
      float alpha[2];
      alpha[0] = alpha[1] = scene->header.adjustable.alpha;
      if (ratio) {
        alpha[0] = alpha[1] = ratio_alpha(shadowed, unshadowed, pitch, n);
        ratio_out[(RATIO_PLANE + c) * area + p] = alpha[0];
      }
      for (int wanted = 0; estimator == ESTIMATOR_AUTO && wanted < 2; wanted++)
        alpha[wanted] = cross_fitted_alpha(shadowed, unshadowed, analytic, pitch, n, parity, wanted);
      for (int i = 0; i < n; i++) {
        const int s = i * pitch;
        all_shadowed += shadowed[s] * HUGE_SAMPLE_SCALE;
        all_unshadowed += unshadowed[s] * HUGE_SAMPLE_SCALE;
        const float a = alpha[(parity + i) & 1], weight = slots->filter_weight[p + s];
        const float rest = shadowed[s] - a * unshadowed[s];
        sample[s] += rest + a * analytic[s];  // which accumulate() weighs
        shadowed[s] = weight * (rest + (a - 1.0f) * analytic[s]);
        if (ratio) unshadowed[s] = within_floats(weight * (analytic[s] - unshadowed[s]));
        analytic[s] *= weight;
      }
    }
  #if HAS(LAYERS)
    if (layers) {
      out[SEEN_PLANE * area + first_pixel + p] = all_shadowed / (float)n / HUGE_SAMPLE_SCALE;
      out[WHOLE_PLANE * area + first_pixel + p] = all_unshadowed / (float)n / HUGE_SAMPLE_SCALE;
    }
  #endif
  }
  for (int c = 0; c < 3 && layers; c++) {
    accumulate_field(slots->analytic + c * slots->capacity, pitch, pixels, n,
                     out + (ANALYTIC_PLANE + c) * area + first_pixel, 0);
    accumulate_field(slots->shadowed + c * slots->capacity, pitch, pixels, n,
                     out + (DIFFERENCE_PLANE + c) * area + first_pixel, 0);
  }
}
#endif

PENUMBRA_NAMESPACE_END
#endif
