// The part of an image that one work unit renders, and the memory that a block of it needs.
#ifndef PENUMBRA_UNIT_H
#define PENUMBRA_UNIT_H
#include "kernels/block/path_state.h"
#include "kernels/film_layers.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  int x, y;  ///< film pixel of the corner
  int width, height;
  uint first_sample;
  int sample_count;
  uint sequence;  ///< of random numbers: 0 that of the scene's seed, others are independent of it
  uint spp;       ///< samples of a pixel for which the sequence is made; 0: as many as the scene says
} Unit;

/// How many pixels' samples a block has slots for. Sample s of its pixel p lies in slot s * slot_pixels + p,
/// so that lanes of pixels read side by side; lanes past the last pixel may read on, and there is room for
/// that.
FN int slot_pixels(int slot_capacity, int sample_count, int lanes) {
  return (slot_capacity - (lanes - 1)) / sample_count;
}

/// What a block notes of the samples of a kind that are not as they should be: how many, and the first of
/// them.
typedef struct {
  uint count;
  uint pixel;   ///< of the unit, row by row
  uint sample;  ///< of the unit's samples
  uint shape;   ///< of BAD_BOUNDARY: whose boundary it met, else 0
} BadSamples;

enum {
  BAD_NAN,
  BAD_INFINITE,
  BAD_BOUNDARY,  ///< finite, but the boundaries of media that its path crossed contradict each other
  BAD_KINDS
};

/// Where a path first held a non-finite value, see block_probe.h.
enum {
  SOURCE_UNKNOWN,
  SOURCE_CAMERA,       ///< the camera ray
  SOURCE_EMISSION,     ///< emission that the path's ray found
  SOURCE_LIGHT,        ///< the light sample
  SOURCE_DIRECTION,    ///< the direction sample: next ray and throughput
  SOURCE_CLOSED_FORM,  ///< of polygon lights
  SOURCE_CONTROL,      ///< their control variate
  SOURCE_FILTER        ///< the film's filter, or a layer
};

// Behind the planes of the layers, of results that have them (FEATURE_MATTES): pairs of planes, of a matte
// and how many of the pixel's samples hit it.
#define MAX_MATTE_PAIRS 32
/// How many pairs a unit of so many samples has: one for each matte that they can hit, and NO_MATTE.
FN int matte_pairs(int sample_count) {
  return sample_count + 1 < MAX_MATTE_PAIRS ? sample_count + 1 : MAX_MATTE_PAIRS;
}

PENUMBRA_NAMESPACE_END
#endif
