// From a block's samples to the statistics of its pixels.
#ifndef PENUMBRA_BLOCK_ACCUMULATE_H
#define PENUMBRA_BLOCK_ACCUMULATE_H
#include "kernels/block_probe.h"

PENUMBRA_NAMESPACE_BEGIN

/// Adds so many bad samples to those noted; the first of them is this one of this pixel.
FN void note_bad(GLOBAL BadSamples* bad, uint count, int pixel, int sample) {
  if (count == 0u) return;
  const bool is_first = (bad->count == 0u) | ((uint)pixel < bad->pixel);
  bad->pixel = is_first ? (uint)pixel : bad->pixel;
  bad->sample = is_first ? (uint)sample : bad->sample;
  bad->count += count;
}

/// Mean and standard deviation, sqrt(mean (v - mean)^2), of a slot field over a pixel's samples: by the
/// deviations from an estimate of the mean that is corrected once, which leaves no rounding of the sum
/// behind, and in units of the largest of them, whose square any float holds.
FN void accumulate_field(const GLOBAL float* RESTRICT values, int first, int count, PRIVATE float* mean,
                         PRIVATE float* deviation) {
  const float n = (float)count;
  float sum = 0.0f;
  for (int s = 0; s < count; s++) sum += values[first + s];
  float estimate = sum / n;
  float rest = 0.0f, largest = 0.0f;
  for (int s = 0; s < count; s++) {
    const float d = values[first + s] - estimate;
    rest += d;
    largest = max_f(largest, FABS(d));
  }
  estimate += rest / n;
  // A power of ten in the range of common radiance, so that nothing changes there.
  const float unit = largest > 1e15f ? 1e15f : (largest < 1e-12f ? 1e-12f : 1.0f);
  rest = 0.0f;
  float squares = 0.0f;
  for (int s = 0; s < count; s++) {
    const float d = (values[first + s] - estimate) / unit;
    rest += d;
    squares += d * d;
  }
  *mean = estimate + unit * (rest / n);
  *deviation = unit * SQRT(max_f(squares - rest * (rest / n), 0.0f) / n);
}

/// Statistics of the block's pixels, in sample order. Samples with a NaN or an infinity count as 0 and are
/// noted in `bad`, of BAD_KINDS.
STAGE void accumulate(const PRIVATE Unit* unit, int first_pixel, int pixels, GLOBAL float* RESTRICT slots,
                      int slot_capacity, bool layers, GLOBAL float* RESTRICT out,
                      GLOBAL BadSamples* RESTRICT bad) {
  const int n = unit->sample_count, area = unit->width * unit->height;
  uint nans = 0u, infinities = 0u;
  int first_nan = pixels * n, first_infinity = first_nan;
  for (int s = 0; s < pixels * n; s++) {
    const float weight = slots[FILTER_WEIGHT * slot_capacity + s];
    const vec3 sample = scale(LOAD3(slots, slot_capacity, SAMPLE_X, s), weight);
    const uint x = FLOAT_BITS(sample.x), y = FLOAT_BITS(sample.y), z = FLOAT_BITS(sample.z);
    const bool nan = is_nan_bits(x) | is_nan_bits(y) | is_nan_bits(z);
    const bool infinite = (is_infinite_bits(x) | is_infinite_bits(y) | is_infinite_bits(z)) & !nan;
    const vec3 kept = select3(nan | infinite, make_vec3(0.0f, 0.0f, 0.0f), sample);
    STORE3(slots, slot_capacity, SAMPLE_X, s, kept);
    nans += nan ? 1u : 0u;
    infinities += infinite ? 1u : 0u;
    first_nan = (nan & (s < first_nan)) ? s : first_nan;
    first_infinity = (infinite & (s < first_infinity)) ? s : first_infinity;
#if HAS(LAYERS)
    for (int k = ALBEDO_X; layers && k <= DEPTH; k++) slots[k * slot_capacity + s] *= weight;
#endif
  }
  for (int p = 0; p < pixels; p++) {
    const int at = first_pixel + p;
    for (int k = 0; k < 3; k++) {
      float mean, deviation;
      accumulate_field(slots + (SAMPLE_X + k) * slot_capacity, p * n, n, &mean, &deviation);
      out[k * area + at] = mean;
      out[(3 + k) * area + at] = deviation;
    }
#if HAS(LAYERS)
    for (int k = 0; layers && k < DEPTH - ALBEDO_X + 1; k++) {
      float mean, deviation;
      accumulate_field(slots + (ALBEDO_X + k) * slot_capacity, p * n, n, &mean, &deviation);
      out[(FIRST_LAYER_PLANE + k) * area + at] = mean;
    }
#endif
  }
  note_bad(bad + BAD_NAN, nans, first_pixel + first_nan / n, first_nan % n);
  note_bad(bad + BAD_INFINITE, infinities, first_pixel + first_infinity / n, first_infinity % n);
}

PENUMBRA_NAMESPACE_END
#endif
