// Combines the samples of polygon lights, with and without shadows, and their closed form into the samples of
// a pixel: see ESTIMATOR_*.
#ifndef PENUMBRA_BLOCK_CONTROL_H
#define PENUMBRA_BLOCK_CONTROL_H
#include "kernels/block/block_accumulate.h"
#include "kernels/integrator/control_variate.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// If any part of a sample is not finite, its plain part becomes NaN or infinite, for accumulate() to count,
/// and the other parts become 0.
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

/// Completes the samples of the block's pixels with their control variates. If the scene has the layers, also
/// writes the closed form G, the estimate of its light minus G (what shadows take away), and the light
/// samples with and without shadows.
STAGE void control_samples(const PRIVATE Scene* scene, const PRIVATE Unit* unit, int first_pixel, int pixels,
                           const PRIVATE SlotState* slots, ulong features, GLOBAL float* RESTRICT out) {
  const int n = unit->sample_count, area = unit->width * unit->height;
  const int estimator = scene->header.integrator.estimator, pitch = slot_pixels(slots->capacity, n, LANES);
  const bool layers = has_layer(features, LAYER_ANALYTIC);
  for (int p = 0; p < pixels; p++)
    for (int s = 0; s < n; s++) check_control(slots, s * pitch + p);
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
      for (int wanted = 0; estimator == ESTIMATOR_AUTO && wanted < 2; wanted++)
        alpha[wanted] = cross_fitted_alpha(shadowed, unshadowed, analytic, pitch, n, parity, wanted);
      for (int i = 0; i < n; i++) {
        const int s = i * pitch;
        all_shadowed += shadowed[s] * HUGE_SAMPLE_SCALE;
        all_unshadowed += unshadowed[s] * HUGE_SAMPLE_SCALE;
        const float a = alpha[(parity + i) & 1], weight = slots->filter_weight[p + s];
        const float rest = shadowed[s] - a * unshadowed[s];
        sample[s] += rest + a * analytic[s];  // accumulate() applies the filter weight
        shadowed[s] = weight * (rest + (a - 1.0f) * analytic[s]);
        analytic[s] *= weight;
      }
    }
    if (layers) {
      GLOBAL float* of_pixel = out + first_pixel + p;
      of_pixel[layer_plane(features, LAYER_SHADOWED) * area] = all_shadowed / (float)n / HUGE_SAMPLE_SCALE;
      of_pixel[layer_plane(features, LAYER_UNSHADOWED) * area] =
          all_unshadowed / (float)n / HUGE_SAMPLE_SCALE;
    }
  }
  for (int c = 0; c < 3 && layers; c++) {
    accumulate_field(slots->analytic + c * slots->capacity, pitch, pixels, n,
                     out + (layer_plane(features, LAYER_ANALYTIC) + c) * area + first_pixel, 0, 0.0f);
    accumulate_field(slots->shadowed + c * slots->capacity, pitch, pixels, n,
                     out + (layer_plane(features, LAYER_DIFFERENCE) + c) * area + first_pixel, 0, 0.0f);
  }
}

PENUMBRA_NAMESPACE_END
#endif
