// The work unit (the part of an image that is rendered at once) and the memory that a block of it needs.
#ifndef PENUMBRA_UNIT_H
#define PENUMBRA_UNIT_H
#include "kernels/block/path_state.h"
#include "kernels/film_layers.h"

PENUMBRA_NAMESPACE_BEGIN

// F(type, name). The scheduler's RenderUnit, the message PixelUnit and the arguments of OpenCL kernels have
// the same fields.
#define UNIT_FIELDS(F)                                                                                     \
  F(int, x) /* film coordinates of the unit's first pixel */                                               \
  F(int, y)                                                                                                \
  F(int, width)                                                                                            \
  F(int, height)                                                                                           \
  F(uint, first_sample)                                                                                    \
  F(uint, sample_count) /* in [1, kMaxSamplesPerUnit] */                                                   \
  F(uint, sequence)     /* random sequence: 0 is that of the scene's seed, others are independent of it */ \
  F(uint, spp)          /* samples per pixel that the sequence is made for; 0: those of the scene */
#define UNIT_FIELD(type, name) type name;
typedef struct {
  UNIT_FIELDS(UNIT_FIELD)
} Unit;
#undef UNIT_FIELD

/// The number of pixels for whose samples a block has slots. Sample s of the block's pixel p lies in slot s *
/// slot_pixels + p, so that lanes of pixels read neighbouring slots. Lanes beyond the last pixel may read
/// further; the capacity includes room for that.
FN int slot_pixels(int slot_capacity, int sample_count, int lanes) {
  return (slot_capacity - (lanes - 1)) / sample_count;
}

/// The bad samples of one kind in a block: how many there are, and where the first one is.
typedef struct {
  uint count;
  uint pixel;   ///< index in the unit, row by row
  uint sample;  ///< index in the unit's samples of that pixel
  uint shape;   ///< BAD_BOUNDARY: index of the shape whose boundary was contradictory; else 0
} BadSamples;

enum {
  BAD_NAN,
  BAD_INFINITE,
  BAD_BOUNDARY,  ///< finite, but the path crossed boundaries of media that contradict each other
  BAD_KINDS
};

/// Where a path first had a non-finite value, see block_probe.h.
enum {
  SOURCE_UNKNOWN,
  SOURCE_CAMERA,       ///< the camera ray
  SOURCE_EMISSION,     ///< emission at the hit of the path's ray
  SOURCE_LIGHT,        ///< the light sample
  SOURCE_DIRECTION,    ///< the direction sample: next ray and throughput
  SOURCE_CLOSED_FORM,  ///< the closed form of polygon lights
  SOURCE_CONTROL,      ///< the control variate of polygon lights
  SOURCE_FILTER        ///< the film's filter, or a layer
};

// Results with FEATURE_MATTES have pairs of planes after those of the layers: an object or material ID
// (matte) and the number of the pixel's samples that hit it.
#define MAX_MATTE_PAIRS 32
/// Number of pairs in a unit with `sample_count` samples: one for each ID that they can hit, and one for
/// NO_MATTE.
FN int matte_pairs(int sample_count) {
  return sample_count + 1 < MAX_MATTE_PAIRS ? sample_count + 1 : MAX_MATTE_PAIRS;
}

PENUMBRA_NAMESPACE_END
#endif
