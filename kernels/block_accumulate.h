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

/// Means and, unless `deviations` is null, standard deviations sqrt(mean (v - mean)^2) of a slot field over
/// each pixel's samples: by the deviations from an estimate of the mean that is corrected once, which leaves
/// no rounding of the sum behind, and in units of the largest of them, whose square any float holds. Pixel
/// p's samples are values[p], values[p + pitch], ...; a lane for each pixel.
STAGE void accumulate_field(const GLOBAL float* RESTRICT values, int pitch, int pixels, int count,
                            GLOBAL float* RESTRICT means, GLOBAL float* RESTRICT deviations) {
  const float n = (float)count;
  for (int p = 0; p < pixels; p += LANES) {
    float estimate[LANES], rest[LANES], unit[LANES], squares[LANES];
    LANE_LOOP
      for (int j = 0; j < LANES; j++) estimate[j] = 0.0f;
    for (int s = 0; s < count; s++) {
      LANE_LOOP
        for (int j = 0; j < LANES; j++) estimate[j] += values[s * pitch + p + j];
    }
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        estimate[j] = estimate[j] / n;
        rest[j] = squares[j] = unit[j] = 0.0f;
      }
    for (int s = 0; s < count; s++) {
      LANE_LOOP
        for (int j = 0; j < LANES; j++) {
          const float d = values[s * pitch + p + j] - estimate[j];
          rest[j] += d;
          unit[j] = max_f(unit[j], FABS(d));
        }
    }
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        estimate[j] += rest[j] / n;
        rest[j] = 0.0f;
        // A power of ten in the range of common radiance, so that nothing changes there.
        unit[j] = unit[j] > 1e15f ? 1e15f : (unit[j] < 1e-12f ? 1e-12f : 1.0f);
      }
    for (int s = 0; s < count && deviations != 0; s++) {
      LANE_LOOP
        for (int j = 0; j < LANES; j++) {
          const float d = (values[s * pitch + p + j] - estimate[j]) / unit[j];
          rest[j] += d;
          squares[j] += d * d;
        }
    }
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        estimate[j] += unit[j] * (rest[j] / n);
        squares[j] = unit[j] * SQRT(max_f(squares[j] - rest[j] * (rest[j] / n), 0.0f) / n);
      }
    const int valid = min_i(LANES, pixels - p);
    for (int j = 0; j < valid; j++) means[p + j] = estimate[j];
    for (int j = 0; j < valid && deviations != 0; j++) deviations[p + j] = squares[j];
  }
}

/// Multiplies a field of neighbouring slots by the samples' filter weights.
STAGE void weigh_field(GLOBAL float* RESTRICT values, const GLOBAL float* RESTRICT weights, int count) {
  LANE_LOOP
    for (int p = 0; p < count; p++) values[p] = values[p] * weights[p];
}

/// Whether any of neighbouring slots' samples has a NaN or an infinity.
STAGE bool any_bad(const GLOBAL float* RESTRICT slots, int slot_capacity, int count) {
  uint bad = 0u;
  LANE_LOOP
    for (int p = 0; p < count; p++) {
      const uint x = FLOAT_BITS(slots[SAMPLE_X * slot_capacity + p]) & 0x7fffffffu;
      const uint y = FLOAT_BITS(slots[SAMPLE_Y * slot_capacity + p]) & 0x7fffffffu;
      const uint z = FLOAT_BITS(slots[SAMPLE_Z * slot_capacity + p]) & 0x7fffffffu;
      bad |= ((x >= 0x7f800000u) | (y >= 0x7f800000u) | (z >= 0x7f800000u)) ? 1u : 0u;
    }
  return bad != 0u;
}

/// Samples with a NaN or an infinity become 0 and are noted in `bad`, of BAD_KINDS.
STAGE void remove_bad(GLOBAL float* RESTRICT slots, int slot_capacity, int pitch, int first_pixel, int pixels,
                      int count, GLOBAL BadSamples* RESTRICT bad) {
  for (int p = 0; p < pixels; p++)
    for (int i = 0; i < count; i++) {
      const int s = i * pitch + p;
      const vec3 sample = LOAD3(slots, slot_capacity, SAMPLE_X, s);
      const uint x = FLOAT_BITS(sample.x), y = FLOAT_BITS(sample.y), z = FLOAT_BITS(sample.z);
      const bool nan = is_nan_bits(x) | is_nan_bits(y) | is_nan_bits(z);
      const bool infinite = (is_infinite_bits(x) | is_infinite_bits(y) | is_infinite_bits(z)) & !nan;
      note_bad(bad + BAD_NAN, nan ? 1u : 0u, first_pixel + p, i);
      note_bad(bad + BAD_INFINITE, infinite ? 1u : 0u, first_pixel + p, i);
      const vec3 kept = select3(nan | infinite, make_vec3(0.0f, 0.0f, 0.0f), sample);
      STORE3(slots, slot_capacity, SAMPLE_X, s, kept);
    }
}

/// Statistics of the block's pixels, in sample order, without samples that are no numbers.
STAGE void accumulate(const PRIVATE Unit* unit, int first_pixel, int pixels, GLOBAL float* RESTRICT slots,
                      int slot_capacity, bool layers, GLOBAL float* RESTRICT out,
                      GLOBAL BadSamples* RESTRICT bad) {
  const int n = unit->sample_count, area = unit->width * unit->height;
  const int pitch = slot_pixels(slot_capacity, n, LANES);
  const int fields = layers ? DEPTH + 1 : ALBEDO_X;
  bool bad_ones = false;
  for (int i = 0; i < n; i++) {
    GLOBAL float* row = slots + i * pitch;
    for (int k = SAMPLE_X; k < fields; k++)
      weigh_field(row + k * slot_capacity, row + FILTER_WEIGHT * slot_capacity, pixels);
    bad_ones = bad_ones | any_bad(row, slot_capacity, pixels);
  }
  if (bad_ones) remove_bad(slots, slot_capacity, pitch, first_pixel, pixels, n, bad);
  for (int k = SAMPLE_X; k < fields; k++) {
    const int plane = k < ALBEDO_X ? k - SAMPLE_X : FIRST_LAYER_PLANE + k - ALBEDO_X;
    accumulate_field(slots + k * slot_capacity, pitch, pixels, n, out + plane * area + first_pixel,
                     k < ALBEDO_X ? out + (3 + plane) * area + first_pixel : 0);
  }
}

PENUMBRA_NAMESPACE_END
#endif
