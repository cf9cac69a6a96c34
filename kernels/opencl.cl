// The OpenCL entry points. The build defines FEATURES and LANES.
#include "kernels/block/block.h"

// A kernel gets a unit as an argument for each of its fields.
#define UNIT_PARAMETER(type, name) type name,
#define UNIT_PARAMETERS UNIT_FIELDS(UNIT_PARAMETER)
#define TAKE_ARGUMENT(type, name) unit.name = name;
#define UNIT_OF_ARGUMENTS \
  Unit unit;              \
  UNIT_FIELDS(TAKE_ARGUMENT)

/// The arguments of the kernels that trace photons.
#define PHOTON_PARAMETERS                                                                             \
  uint map, uint sequence, int photon_paths, int first, int end, int capacity, __global uint *states, \
      __global Photon *photons, __global int *photon_count, int photon_room

/// Traces the photon paths [first, first + count) in a block at `states`.
STAGE void trace_block_of_photons(GLOBAL const SceneHeader* header, GLOBAL const uint* words, uint map,
                                  uint sequence, int photon_paths, int first, int count, int capacity,
                                  GLOBAL uint* states, PhotonStore store) {
  const Scene scene = make_scene(*header, words);
  const Block block = make_block(COMPILED_FEATURES, states, capacity, 0, 1);
  PhotonTask task;
  task.map = map;
  task.sequence = sequence;
  task.paths = photon_paths;
  if (HAS(PHOTONS)) trace_photons(&scene, &task, first, count, &block, store);
}

#if LANES > 1
/// The work of one work item of render_blocks. It is not in the kernel itself, of which PoCL makes three
/// functions.
STAGE void render_free_blocks(int item, GLOBAL const SceneHeader* header, GLOBAL const uint* words,
                              GLOBAL const uint* photons, Unit unit, int first_pixel, int end_pixel,
                              int block_pixels, int capacity, int slot_capacity, GLOBAL uint* states,
                              GLOBAL uint* slots, GLOBAL float* out, GLOBAL BadSamples* bad,
                              volatile GLOBAL int* next_block) {
  const Scene scene = scene_of_unit(*header, words, photons, &unit);
  const Block block = make_block(
      COMPILED_FEATURES, states + (size_t)item * path_words(COMPILED_FEATURES) * capacity, capacity,
      slots + (size_t)item * slot_words(COMPILED_FEATURES) * slot_capacity, slot_capacity);
  const int blocks = (end_pixel - first_pixel + block_pixels - 1) / block_pixels;
  for (int b = atomic_inc(next_block); b < blocks; b = atomic_inc(next_block)) {
    const int pixel = first_pixel + b * block_pixels;
    const int pixels = min_i(block_pixels, end_pixel - pixel);
    render_block(&scene, &unit, pixel, pixels, &block, out, bad + BAD_KINDS * item);
  }
}

/// For CPUs: renders pixels [first_pixel, end_pixel) of the unit in blocks of `block_pixels`; each free work
/// item takes the next block. `next_block` counts from 0. `states` and `slots` have the memory of each work
/// item's block, one after the other; `bad` has BAD_KINDS entries per work item.
__kernel void render_blocks(__global const SceneHeader* header, __global const uint* words,
                            __global const uint* photons, UNIT_PARAMETERS int first_pixel, int end_pixel,
                            int block_pixels, int capacity, int slot_capacity, __global uint* states,
                            __global uint* slots, __global float* out, __global BadSamples* bad,
                            volatile __global int* next_block) {
  UNIT_OF_ARGUMENTS
  render_free_blocks((int)get_global_id(0), header, words, photons, unit, first_pixel, end_pixel,
                     block_pixels, capacity, slot_capacity, states, slots, out, bad, next_block);
}

/// For CPUs: traces the photon paths [first, end) in blocks of `capacity`, like render_blocks.
__kernel void trace_photon_paths(__global const SceneHeader* header, __global const uint* words,
                                 PHOTON_PARAMETERS, volatile __global int* next_block) {
  const PhotonStore store = {photons, photon_count, photon_room};
  const int item = (int)get_global_id(0), blocks = (end - first + capacity - 1) / capacity;
  for (int b = atomic_inc(next_block); b < blocks; b = atomic_inc(next_block)) {
    const int from = first + b * capacity;
    trace_block_of_photons(header, words, map, sequence, photon_paths, from, min_i(capacity, end - from),
                           capacity, states + (size_t)item * path_words(COMPILED_FEATURES) * capacity, store);
  }
}
#else
// For GPUs: one work item per path, and then one per pixel. The paths of all pixels [first_pixel, ...) share
// `slots`. Each work item's block is one lane of a wide block, so that fields of neighbouring paths are
// adjacent in memory.

/// Traces paths [first_path, first_path + path_count) of the pixels, at most `capacity`.
__kernel void trace_paths(__global const SceneHeader* header, __global const uint* words,
                          __global const uint* photons, UNIT_PARAMETERS int first_pixel, int first_path,
                          int path_count, int capacity, int slot_capacity, __global uint* states,
                          __global uint* slots) {
  const int item = (int)get_global_id(0);
  if (item >= path_count) return;
  UNIT_OF_ARGUMENTS
  const Scene scene = scene_of_unit(*header, words, photons, &unit);
  const Block block = make_block(COMPILED_FEATURES, states + item, capacity, slots, slot_capacity);
  render_paths(&scene, &unit, first_pixel, first_path + item, 1, 1, &block);
}

/// Finishes pixels [first_pixel + from, first_pixel + from + count); `bad` has BAD_KINDS entries per work
/// item.
__kernel void finish_samples(__global const SceneHeader* header, __global const uint* words,
                             __global const uint* photons, UNIT_PARAMETERS int first_pixel, int from,
                             int count, int slot_capacity, __global uint* slots, __global float* out,
                             __global BadSamples* bad) {
  const int item = (int)get_global_id(0);
  if (item >= count) return;
  UNIT_OF_ARGUMENTS
  const Scene scene = scene_of_unit(*header, words, photons, &unit);
  const Block block = make_block(COMPILED_FEATURES, 0, 1, slots + from + item, slot_capacity);
  finish_pixels(&scene, &unit, first_pixel + from + item, 1, &block, out, bad + BAD_KINDS * item);
}

/// Traces the photon paths [first, end), at most `capacity`.
__kernel void trace_photon_paths(__global const SceneHeader* header, __global const uint* words,
                                 PHOTON_PARAMETERS, volatile __global int* next_block) {
  const PhotonStore store = {photons, photon_count, photon_room};
  const int item = (int)get_global_id(0);
  if (first + item >= end) return;
  trace_block_of_photons(header, words, map, sequence, photon_paths, first + item, 1, capacity, states + item,
                         store);
}
#endif
