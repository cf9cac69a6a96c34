// Computes the statistics of a block's pixels from its samples.
#ifndef PENUMBRA_BLOCK_ACCUMULATE_H
#define PENUMBRA_BLOCK_ACCUMULATE_H
#include "kernels/block/block_probe.h"

PENUMBRA_NAMESPACE_BEGIN

/// Counts `count` more bad samples of a pixel. The first of them has index `sample` and met `shape`.
FN void note_bad(GLOBAL BadSamples* bad, uint count, int pixel, int sample, uint shape) {
  if (count == 0u) return;
  const bool is_first = (bad->count == 0u) | ((uint)pixel < bad->pixel);
  bad->pixel = is_first ? (uint)pixel : bad->pixel;
  bad->sample = is_first ? (uint)sample : bad->sample;
  bad->shape = is_first ? shape : bad->shape;
  bad->count += count;
}

// Above this, the sum of 4096 samples, or the square of a difference in units of 1e15, may overflow a float.
#define HUGE_SAMPLE 1e30f
#define HUGE_SAMPLE_SCALE \
  9.094947017729282e-13f  // 2^-40: exact, except for samples that are negligible beside a huge one

/// Clamps results that rounding carried past the largest float. A NaN stays a NaN.
FN float within_floats(float x) {
  const float most = 3.402823466e+38f;
  const float below = x > most ? most : x;
  return below < -most ? -most : below;
}

/// Means and, unless `deviations` is null, standard deviations sqrt(mean (v - mean)^2) of a slot field over
/// each pixel's samples. Deviations are taken from an estimate of the mean that is corrected once, which
/// removes the rounding error of the sum. They are in units of a power of ten, so that their squares do not
/// overflow. If the sum or the differences might overflow, the samples are temporarily scaled by a power of
/// two: both statistics of finite samples are finite. Pixel p's samples are values[p], values[p + pitch],
/// ...; each lane has one pixel. `correction`: 1 adds the second correction of the mean, which only
/// deviations bring; 0: the mean does not depend on whether there are any.
STAGE void accumulate_field(const GLOBAL float* RESTRICT values, int pitch, int pixels, int count,
                            GLOBAL float* RESTRICT means, GLOBAL float* RESTRICT deviations,
                            float correction) {
  const float n = (float)count;
  for (int p = 0; p < pixels; p += LANES) {
    float estimate[LANES], rest[LANES], unit[LANES], squares[LANES];
    float scaled_sum[LANES], largest[LANES], scale[LANES], inverse[LANES];
    LANE_LOOP
      for (int j = 0; j < LANES; j++) estimate[j] = scaled_sum[j] = largest[j] = 0.0f;
    for (int s = 0; s < count; s++) {
      LANE_LOOP
        for (int j = 0; j < LANES; j++) {
          const float value = values[s * pitch + p + j];
          estimate[j] += value;
          scaled_sum[j] += value * HUGE_SAMPLE_SCALE;
          largest[j] = max_f(largest[j], FABS(value));
        }
    }
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        const bool huge = largest[j] > HUGE_SAMPLE;
        scale[j] = huge ? HUGE_SAMPLE_SCALE : 1.0f;
        inverse[j] = huge ? 1.0f / HUGE_SAMPLE_SCALE : 1.0f;
        estimate[j] = (huge ? scaled_sum[j] : estimate[j]) / n;
        rest[j] = squares[j] = unit[j] = 0.0f;
      }
    for (int s = 0; s < count; s++) {
      LANE_LOOP
        for (int j = 0; j < LANES; j++) {
          const float d = values[s * pitch + p + j] * scale[j] - estimate[j];
          rest[j] += d;
          unit[j] = max_f(unit[j], FABS(d));
        }
    }
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        estimate[j] += rest[j] / n;
        rest[j] = 0.0f;
        // A power of ten; it is 1 for common radiance, so that nothing changes there.
        unit[j] = unit[j] > 1e15f ? 1e15f : (unit[j] < 1e-12f ? 1e-12f : 1.0f);
      }
    for (int s = 0; s < count && deviations != 0; s++) {
      LANE_LOOP
        for (int j = 0; j < LANES; j++) {
          const float d = (values[s * pitch + p + j] * scale[j] - estimate[j]) / unit[j];
          rest[j] += d;
          squares[j] += d * d;
        }
    }
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        estimate[j] = within_floats((estimate[j] + correction * (unit[j] * (rest[j] / n))) * inverse[j]);
        squares[j] =
            within_floats(unit[j] * SQRT(max_f(squares[j] - rest[j] * (rest[j] / n), 0.0f) / n) * inverse[j]);
      }
    const int valid = min_i(LANES, pixels - p);
    for (int j = 0; j < valid; j++) means[p + j] = estimate[j];
    for (int j = 0; j < valid && deviations != 0; j++) deviations[p + j] = squares[j];
  }
}

/// Multiplies a field of neighbouring slots by the filter weights of the samples.
STAGE void weigh_field(GLOBAL float* RESTRICT values, const GLOBAL float* RESTRICT weights, int count) {
  LANE_LOOP
    for (int p = 0; p < count; p++) values[p] = values[p] * weights[p];
}

// The values of a sample: its radiance, then those layers with a slot field that are FILTERED, or those of
// another mean.
#define RADIANCE_VALUES 3

typedef struct {
  GLOBAL float* samples;  ///< an array over the slots; 0: there is no such value
  int plane;              ///< the plane that gets their mean
} SampleValue;

/// The k-th value of the layers of that mean.
FN SampleValue layer_value(const PRIVATE SlotState* slots, ulong features, int wanted, int k) {
  SampleValue value;
  value.samples = 0;
  value.plane = 0;
#define TAKE_LAYER(NAME, planes, needs, field, mean, layer, channels)                            \
  {                                                                                              \
    GLOBAL float* field_of_layer = field;                                                        \
    const bool there = field_of_layer != 0 && mean == wanted && LAYER_IS_THERE(features, needs); \
    if (there && k >= 0 && k < planes) {                                                         \
      value.samples = field_of_layer + k * slots->capacity;                                      \
      value.plane = layer_plane(features, LAYER_##NAME) + k;                                     \
    }                                                                                            \
    k -= there ? planes : 0;                                                                     \
  }
  PENUMBRA_FILM_LAYERS(TAKE_LAYER)
#undef TAKE_LAYER
  return value;
}

/// The k-th value that is weighted by the film's filter.
FN SampleValue filtered_value(const PRIVATE SlotState* slots, ulong features, int k) {
  SampleValue radiance;
  radiance.samples = slots->sample + k * slots->capacity;
  radiance.plane = k;
  return k < RADIANCE_VALUES ? radiance : layer_value(slots, features, FILTERED, k - RADIANCE_VALUES);
}

/// Whether the k-th filtered value is light: the radiance, or a part of it.
FN bool is_light(ulong features, int k, int plane) {
  return k < RADIANCE_VALUES ||
         (plane >= layer_plane(features, LAYER_DIRECT) && plane < layer_plane(features, LAYER_INDIRECT + 1));
}

/// Whether any of `count` neighbouring values is NaN or infinite.
STAGE bool any_bad(const GLOBAL float* RESTRICT values, int count) {
  uint bad = 0u;
  LANE_LOOP
    for (int p = 0; p < count; p++) {
      const uint bits = FLOAT_BITS(values[p]) & 0x7fffffffu;
      bad |= bits >= 0x7f800000u ? 1u : 0u;
    }
  return bad != 0u;
}

/// Counts samples with a NaN or infinity in a filtered value in `bad`, which has BAD_KINDS entries. Their
/// light becomes 0, and so does each non-finite value of their other layers.
STAGE void remove_bad(const PRIVATE SlotState* slots, ulong features, int pitch, int first_pixel, int pixels,
                      int count, GLOBAL BadSamples* RESTRICT bad) {
  for (int p = 0; p < pixels; p++)
    for (int i = 0; i < count; i++) {
      const int slot = i * pitch + p;
      bool nan = false, infinite = false;
      for (int k = 0; filtered_value(slots, features, k).samples != 0; k++) {
        const uint bits = FLOAT_BITS(filtered_value(slots, features, k).samples[slot]);
        nan = nan | is_nan_bits(bits);
        infinite = infinite | is_infinite_bits(bits);
      }
      note_bad(bad + BAD_NAN, nan ? 1u : 0u, first_pixel + p, i, 0u);
      note_bad(bad + BAD_INFINITE, (infinite & !nan) ? 1u : 0u, first_pixel + p, i, 0u);
      for (int k = 0; filtered_value(slots, features, k).samples != 0; k++) {
        const SampleValue of_sample = filtered_value(slots, features, k);
        GLOBAL float* value = of_sample.samples + slot;
        const uint bits = FLOAT_BITS(*value);
        const bool own = is_nan_bits(bits) | is_infinite_bits(bits);
        *value = (is_light(features, k, of_sample.plane) ? nan | infinite : own) ? 0.0f : *value;
      }
    }
}

/// Handles planes from `first_plane` on, which are not computed from slot fields. If one of them is NaN or
/// infinite in a pixel, all of them become 0 there, and the pixel's samples become NaN or infinite, for
/// accumulate() to count.
STAGE void spread_bad_planes(const PRIVATE Unit* unit, int first_pixel, int pixels, int first_plane,
                             int planes, const PRIVATE SlotState* slots, GLOBAL float* RESTRICT out) {
  const int n = unit->sample_count, area = unit->width * unit->height;
  const int pitch = slot_pixels(slots->capacity, n, LANES);
  for (int p = 0; p < pixels; p++) {
    GLOBAL float* plane = out + first_pixel + p;
    float worst = 0.0f;
    for (int k = first_plane; k < planes; k++) {
      const uint bits = FLOAT_BITS(plane[k * area]);
      const bool bad = is_nan_bits(bits) | is_infinite_bits(bits);
      worst += bad ? plane[k * area] : 0.0f;
    }
    const bool any = worst != 0.0f;  // also if NaN
    for (int k = first_plane; any && k < planes; k++) plane[k * area] = 0.0f;
    for (int i = 0; any && i < n; i++) slots->sample[i * pitch + p] = worst;
  }
}

/// Which half of the samples a sample belongs to (0 or 1): the parity of the bits of its index. Each aligned
/// pair of samples has one of either half. In sequences of low discrepancy both halves cover the pixel
/// evenly; by even and odd indices they would cover different parts of it.
FN uint half_of_sample(uint sample) { return (uint)BIT_COUNT(sample) & 1u; }

/// Sums of those samples of a slot field that are in half `which`, over the number of all samples. Samples
/// that share a photon map are in the same half.
STAGE void accumulate_half(const GLOBAL float* RESTRICT values, int pitch, int pixels,
                           const PRIVATE Unit* unit, uint samples_per_map, uint which,
                           GLOBAL float* RESTRICT means) {
  const float share = 1.0f / (float)unit->sample_count;
  for (int p = 0; p < pixels; p++) means[p] = 0.0f;
  for (uint s = 0; s < unit->sample_count; s++) {
    if (half_of_sample((unit->first_sample + s) / samples_per_map) != which) continue;
    const GLOBAL float* RESTRICT of_sample = values + (int)s * pitch;
    LANE_LOOP
      for (int p = 0; p < pixels; p++) means[p] = within_floats(means[p] + of_sample[p] * share);
  }
}

/// The layers of FEATURE_DENOISING for which there are no slot fields.
STAGE void accumulate_halves(const PRIVATE Unit* unit, int first_pixel, int pixels,
                             const PRIVATE SlotState* slots, ulong features, uint samples_per_map,
                             GLOBAL float* RESTRICT out) {
  const int n = (int)unit->sample_count, area = unit->width * unit->height;
  const int pitch = slot_pixels(slots->capacity, n, LANES);
  GLOBAL float* pixel = out + first_pixel;
  for (int c = 0; c < RADIANCE_VALUES; c++) {
    const GLOBAL float* samples = slots->sample + c * slots->capacity;
    accumulate_half(samples, pitch, pixels, unit, samples_per_map, 0u,
                    pixel + (layer_plane(features, LAYER_HALF_A) + c) * area);
    accumulate_half(samples, pitch, pixels, unit, samples_per_map, 1u,
                    pixel + (layer_plane(features, LAYER_HALF_B) + c) * area);
  }
  int in_a = 0;
  for (int s = 0; s < n; s++)
    in_a += half_of_sample((unit->first_sample + (uint)s) / samples_per_map) == 0u ? 1 : 0;
  GLOBAL float* share = pixel + layer_plane(features, LAYER_HALF_SHARE) * area;
  for (int p = 0; p < pixels; p++) share[p] = (float)in_a / (float)n;
}

/// Statistics of the block's pixels, in sample order, without non-finite samples.
STAGE void accumulate(const PRIVATE Unit* unit, int first_pixel, int pixels, const PRIVATE SlotState* slots,
                      ulong features, GLOBAL float* RESTRICT out, GLOBAL BadSamples* RESTRICT bad) {
  const int n = unit->sample_count, area = unit->width * unit->height;
  const int pitch = slot_pixels(slots->capacity, n, LANES);
  const bool has_variances = has_layer(features, LAYER_ALBEDO_VARIANCE);
  bool bad_ones = false;
  for (int k = 0; filtered_value(slots, features, k).samples != 0; k++) {
    GLOBAL float* samples = filtered_value(slots, features, k).samples;
    for (int i = 0; i < n; i++) {
      weigh_field(samples + i * pitch, slots->filter_weight + i * pitch, pixels);
      bad_ones = bad_ones | any_bad(samples + i * pitch, pixels);
    }
  }
  if (bad_ones) remove_bad(slots, features, pitch, first_pixel, pixels, n, bad);
  for (int k = 0; filtered_value(slots, features, k).samples != 0; k++) {
    const SampleValue value = filtered_value(slots, features, k);
    GLOBAL float* means = out + value.plane * area + first_pixel;
    const int layer_value_index = value.plane - RADIANCE_PLANES;
    GLOBAL float* deviations = 0;
    if (k < RADIANCE_VALUES) deviations = means + RADIANCE_VALUES * area;
    if (has_variances & (layer_value_index >= 0) & (layer_value_index < FEATURE_PLANES))
      deviations = means + FEATURE_PLANES * area;
    accumulate_field(value.samples, pitch, pixels, n, means, deviations, k < RADIANCE_VALUES ? 1.0f : 0.0f);
  }
  for (int k = 0; layer_value(slots, features, UNFILTERED, k).samples != 0; k++) {
    const SampleValue value = layer_value(slots, features, UNFILTERED, k);
    accumulate_field(value.samples, pitch, pixels, n, out + value.plane * area + first_pixel, 0, 0.0f);
  }
  for (int k = 0; layer_value(slots, features, FIRST_SAMPLE, k).samples != 0; k++) {
    const SampleValue value = layer_value(slots, features, FIRST_SAMPLE, k);
    for (int p = 0; p < pixels; p++) out[value.plane * area + first_pixel + p] = value.samples[p];
  }
}

/// Counts the samples whose paths crossed contradictory boundaries.
STAGE void note_contradictions(const PRIVATE Unit* unit, int first_pixel, int pixels,
                               const PRIVATE SlotState* slots, GLOBAL BadSamples* RESTRICT bad) {
  const int n = unit->sample_count, pitch = slot_pixels(slots->capacity, n, LANES);
  for (int p = 0; p < pixels; p++)
    for (int i = 0; i < n; i++) {
      const int shape = slots->contradiction[i * pitch + p] - 1;  // negative: none, or unknown
      if (shape >= 0) note_bad(bad + BAD_BOUNDARY, 1u, first_pixel + p, i, (uint)shape);
    }
}

/// Counts which mattes a pixel's samples hit, without filter weights. NO_MATTE comes first, then mattes in
/// the order of the samples; unused pairs are 0. A matte for which no pair is left counts as NO_MATTE, so
/// that the counts of a pixel add up to its samples.
STAGE void accumulate_mattes(const PRIVATE Unit* unit, int first_pixel, int pixels,
                             const PRIVATE SlotState* slots, ulong features, GLOBAL float* RESTRICT out) {
  const int n = unit->sample_count, area = unit->width * unit->height, pairs = matte_pairs(n);
  const int pitch = slot_pixels(slots->capacity, n, LANES);
  for (int p = 0; p < pixels; p++) {
    GLOBAL float* mattes = out + plane_count(features) * area + first_pixel + p;
    GLOBAL float* counts = mattes + area;
    for (int k = 0; k < pairs; k++) mattes[2 * k * area] = counts[2 * k * area] = 0.0f;
    int used = 1;
    for (int s = 0; s < n; s++) {
      const float matte = (float)slots->matte[s * pitch + p];
      int k = 0;
      while (k < used && mattes[2 * k * area] != matte) k++;
      k = k < pairs ? k : 0;
      if (k == used) {
        mattes[2 * k * area] = matte;
        used++;
      }
      counts[2 * k * area] += 1.0f;
    }
  }
}

PENUMBRA_NAMESPACE_END
#endif
