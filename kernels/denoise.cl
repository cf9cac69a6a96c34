// The OpenCL entry point of denoising.
#include "kernels/denoise/denoise.h"

/// Each work item takes every n-th tile of n items; `scratch` has denoise_scratch_floats for each item.
__kernel void denoise_tiles(__global const DenoiseTask* task, __global const float* guide,
                            __global const float* sources, __global float* models, __global float* scratch,
                            __global float* out) {
  const int item = (int)get_global_id(0), items = (int)get_global_size(0);
  __global float* own = scratch + (size_t)item * (size_t)denoise_scratch_floats(task);
  for (int tile = item; tile < denoise_tiles_of(task); tile += items)
    denoise_tile_of(task, tile, guide, sources, models, own, out);
}
