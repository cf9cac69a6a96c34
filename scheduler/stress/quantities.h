// The quantities that the cases of `penumbra stress` compute with the kernels. One function in portable
// source evaluates all of them, so that every instruction set and every OpenCL device computes exactly the
// same. Inputs and outputs are doubles, which represent every float exactly. The build defines FEATURES and
// LANES.
#ifndef PENUMBRA_STRESS_QUANTITIES_H
#define PENUMBRA_STRESS_QUANTITIES_H
#include "kernels/block/block_accumulate.h"
#include "kernels/sampler/filter.h"
#include "kernels/sampler/sampler.h"
#include "scheduler/stress/bsdf_quantities.h"
#include "scheduler/stress/geometry_quantities.h"
#include "scheduler/stress/light_quantities.h"
#include "scheduler/stress/medium_quantities.h"
#include "scheduler/stress/quantity_numbers.h"

PENUMBRA_NAMESPACE_BEGIN

/// In: 0 cosine, 1 uniform hemisphere, 2 uniform sphere; normal, u, v. Out: direction.
STAGE void direction_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const int kind = (int)in[0];
  const vec3 n = in_v(in, 1);
  const float u = in_f(in, 4), v = in_f(in, 5);
  const vec3 cosine = sample_cosine_hemisphere(n, u, v), uniform = sample_uniform_hemisphere(n, u, v);
  const vec3 sphere = sample_uniform_sphere(u, v);
  out_v(out, 0, kind == 0 ? cosine : (kind == 1 ? uniform : sphere));
}

/// In: normal, vector. Out: the vector in the normal's frame; the error of transforming it back.
STAGE void frame_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const vec3 n = in_v(in, 0), v = in_v(in, 3);
  const vec3 inside = to_frame(n, v), again = from_frame(n, inside.x, inside.y, inside.z);
  out_v(out, 0, inside);
  out[3] = length3(sub(again, v));
}

/// In: SAMPLER_*, samples per pixel, seed, pixel x and y, first sample, number of samples, pair of
/// dimensions. Out: smallest u, largest u, smallest v, largest v, mean u, mean v; the number of cells that
/// contain a sample, in a grid with as many cells as samples (for up to 65536 samples; its columns are given
/// by strata_columns).
STAGE void sampler_quantity(GLOBAL const double* in, GLOBAL double* out, GLOBAL uint* scratch) {
  const int kind = (int)in[0];
  const uint spp = in_u(in, 1), pixel = pixel_hash(in_u(in, 2), in_u(in, 3), in_u(in, 4));
  const uint first = in_u(in, 5), count = in_u(in, 6), pair = in_u(in, 7);
  const uint columns = strata_columns(count), rows = count / columns;
  for (int i = 0; i < 2048; i++) scratch[i] = 0u;
  double low_u = 2.0, low_v = 2.0, high_u = -1.0, high_v = -1.0, sum_u = 0.0, sum_v = 0.0;
  for (uint i = 0; i < count; i++) {
    float u, v;
    if (kind == SAMPLER_STRATIFIED)
      stratified_pair(pixel, first + i, pair, spp, &u, &v);
    else if (kind == SAMPLER_HALTON)
      halton_pair(pixel, first + i, pair, &u, &v);
    else if (kind == SAMPLER_INDEPENDENT)
      independent_pair(pixel, first + i, pair, &u, &v);
    else
      sobol_pair(pixel, first + i, pair, &u, &v);
    low_u = min_d(low_u, u);
    low_v = min_d(low_v, v);
    high_u = max_d(high_u, u);
    high_v = max_d(high_v, v);
    sum_u += u;
    sum_v += v;
    const uint cell = (uint)(u * (float)columns) + columns * (uint)(v * (float)rows);
    if (cell < 65536u) scratch[cell >> 5] |= 1u << (cell & 31u);
  }
  double hit = 0.0;
  for (uint i = 0; i < 65536u; i++) hit += (scratch[i >> 5] >> (i & 31u)) & 1u ? 1.0 : 0.0;
  out[0] = low_u;
  out[1] = high_u;
  out[2] = low_v;
  out[3] = high_v;
  out[4] = sum_u / (double)count;
  out[5] = sum_v / (double)count;
  out[6] = hit;
}

/// In: index, base. Out: the radical inverse.
STAGE void radical_inverse_quantity(GLOBAL const double* in, GLOBAL double* out) {
  out[0] = radical_inverse(in_u(in, 0), in_u(in, 1));
}

/// In: number of samples, base, step, period; sample i is base + step (i % period). Out: mean, sum of squared
/// deviations.
STAGE void accumulate_quantity(GLOBAL const double* in, GLOBAL double* out, GLOBAL uint* scratch) {
  GLOBAL float* values = (GLOBAL float*)scratch;
  const int count = (int)in[0], period = (int)in[3];
  for (int i = 0; i < count; i++) values[i] = in_f(in, 1) + in_f(in, 2) * (float)(i % period);
  GLOBAL float* statistics = values + count + LANES;
  accumulate_field(values, 1, 1, count, statistics, statistics + 1, 1.0f);
  out[0] = statistics[0];
  out[1] = (double)statistics[1] * statistics[1] * count;
}

/// In: MATH_*, x, y. Out: the function's value.
STAGE void math_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const int function = (int)in[0];
  const float x = in_f(in, 1), y = in_f(in, 2);
  float sine, cosine;
  sincos_2pi(clamp_f(x, -2.0f, 2.0f), &sine, &cosine);
  if (function == MATH_EXP) out[0] = exp_f(x);
  if (function == MATH_EXPM1) out[0] = expm1_f(x);
  if (function == MATH_LOG) out[0] = log_f(x);
  if (function == MATH_LOG1P) out[0] = log1p_f(x);
  if (function == MATH_ATAN2) out[0] = atan2_f(y, x);
  if (function == MATH_SIN_2PI) out[0] = sine;
  if (function == MATH_COS_2PI) out[0] = cosine;
}

/// In: FILTER_BOX or FILTER_TENT, u. Out: offset.
STAGE void filter_quantity(GLOBAL const double* in, GLOBAL double* out, GLOBAL uint* scratch) {
  const Scene scene = scratch_scene(scratch);
  out[0] = sample_filter((int)in[0], scene.filter_table, in_f(in, 1)).x;
}

/// Evaluates one quantity: QUANTITY_INPUTS numbers in, QUANTITY_OUTPUTS out, with QUANTITY_SCRATCH words of
/// scratch memory.
STAGE void quantity(int id, GLOBAL const double* in, GLOBAL double* out, GLOBAL uint* scratch) {
  for (int i = 0; i < QUANTITY_OUTPUTS; i++) out[i] = 0.0;
  if (id == QUANTITY_POLYGON) polygon_quantity(in, out, scratch);
  if (id == QUANTITY_SPHERICAL_TRIANGLE) spherical_triangle_quantity(in, out);
  if (id == QUANTITY_SPHERICAL_RECTANGLE) spherical_rectangle_quantity(in, out);
  if (id == QUANTITY_PROJECTED_TRIANGLE) projected_triangle_quantity(in, out);
  if (id == QUANTITY_BSDF_VALUE) bsdf_value_quantity(in, out);
  if (id == QUANTITY_BSDF_SAMPLE) bsdf_sample_quantity(in, out);
  if (id == QUANTITY_BSDF_ALBEDO) bsdf_albedo_quantity(in, out);
  if (id == QUANTITY_DIRECTION) direction_quantity(in, out);
  if (id == QUANTITY_FRAME) frame_quantity(in, out);
  if (id == QUANTITY_SAMPLER) sampler_quantity(in, out, scratch);
  if (id == QUANTITY_RADICAL_INVERSE) radical_inverse_quantity(in, out);
  if (id == QUANTITY_WATERTIGHT) watertight_quantity(in, out);
  if (id == QUANTITY_SURFACE) surface_quantity(in, out, scratch);
  if (id == QUANTITY_SPHERE) sphere_quantity(in, out);
  if (id == QUANTITY_CAMERA) camera_quantity(in, out);
  if (id == QUANTITY_MIS) mis_quantity(in, out);
  if (id == QUANTITY_SPHERE_LIGHT) sphere_light_quantity(in, out, scratch);
  if (id == QUANTITY_ACCUMULATE) accumulate_quantity(in, out, scratch);
  if (id == QUANTITY_MATH) math_quantity(in, out);
  if (id == QUANTITY_FILTER) filter_quantity(in, out, scratch);
  if (id == QUANTITY_MIXTURE_VALUE) mixture_value_quantity(in, out);
  if (id == QUANTITY_MIXTURE_SAMPLES) mixture_samples_quantity(in, out);
  if (id == QUANTITY_FRESNEL) fresnel_quantity(in, out);
  if (id == QUANTITY_UNDISTORT) undistort_quantity(in, out);
  if (id == QUANTITY_PHASE) phase_quantity(in, out);
  if (id == QUANTITY_FLIGHT_DEPTH) flight_depth_quantity(in, out);
  if (id == QUANTITY_FLIGHT_WEIGHT) flight_weight_quantity(in, out);
  if (id == QUANTITY_SIGHT) sight_quantity(in, out);
}

PENUMBRA_NAMESPACE_END
#endif
