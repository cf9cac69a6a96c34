// A block: the state of many paths, one array per field. Field F of lane i is at f[F * capacity + i].
#ifndef PENUMBRA_PATH_STATE_H
#define PENUMBRA_PATH_STATE_H
#include "kernels/features.h"
#include "kernels/math/vec3.h"

PENUMBRA_NAMESPACE_BEGIN

// clang-format off
// Fields that travel with a path when the block is compacted.
#define PATH_FLOATS(F)                                              \
  F(RAY_ORIGIN_X) F(RAY_ORIGIN_Y) F(RAY_ORIGIN_Z)                   \
  F(RAY_DIRECTION_X) F(RAY_DIRECTION_Y) F(RAY_DIRECTION_Z) /* unit */ \
  F(RAY_TMAX)                        /* negative: no ray this time */ \
  F(THROUGHPUT_X) F(THROUGHPUT_Y) F(THROUGHPUT_Z)                   \
  F(DIRECTION_PDF)                   /* of the ray's direction, per solid angle */ \
  F(RADIANCE_X) F(RADIANCE_Y) F(RADIANCE_Z)

// As above, used by the direct integrator: the camera ray, whose hit all its samples share. Where lights are
// sampled by projected solid angle, a path keeps there the shading normal that its ray left.
#define CAMERA_RAY_FLOATS(F)                               \
  F(CAMERA_ORIGIN_X) F(CAMERA_ORIGIN_Y) F(CAMERA_ORIGIN_Z) \
  F(CAMERA_DIRECTION_X) F(CAMERA_DIRECTION_Y) F(CAMERA_DIRECTION_Z)

// Fields that live from a step to its occlusion test.
#define SHADOW_FLOATS(F)                                        \
  F(SHADOW_ORIGIN_X) F(SHADOW_ORIGIN_Y) F(SHADOW_ORIGIN_Z)      \
  F(SHADOW_DIRECTION_X) F(SHADOW_DIRECTION_Y) F(SHADOW_DIRECTION_Z) \
  F(SHADOW_TMAX)                 /* negative: no shadow ray */  \
  F(SHADOW_RADIANCE_X) F(SHADOW_RADIANCE_Y) F(SHADOW_RADIANCE_Z) /* added if nothing is in the way */

// Where polygon lights have control variates: sums over the path's shadow rays towards them, with and without
// shadows, and over its closed forms. They travel with the path.
#define CONTROL_FLOATS(F)                                       \
  F(SHADOWED_X) F(SHADOWED_Y) F(SHADOWED_Z)                     \
  F(UNSHADOWED_X) F(UNSHADOWED_Y) F(UNSHADOWED_Z)               \
  F(ANALYTIC_X) F(ANALYTIC_Y) F(ANALYTIC_Z)

// Indexed by the path's slot, not its lane: they stay where they are. FILTER_WEIGHT multiplies the sample.
#define SLOT_FLOATS(F)                                   \
  F(FILTER_WEIGHT)                                       \
  F(SAMPLE_X) F(SAMPLE_Y) F(SAMPLE_Z)                    \
  F(ALBEDO_X) F(ALBEDO_Y) F(ALBEDO_Z)                    \
  F(NORMAL_X) F(NORMAL_Y) F(NORMAL_Z)                    \
  F(DEPTH)

// The same of CONTROL_FLOATS, in its order.
#define SLOT_CONTROL_FLOATS(F)                                             \
  F(SLOT_SHADOWED_X) F(SLOT_SHADOWED_Y) F(SLOT_SHADOWED_Z)                 \
  F(SLOT_UNSHADOWED_X) F(SLOT_UNSHADOWED_Y) F(SLOT_UNSHADOWED_Z)           \
  F(SLOT_ANALYTIC_X) F(SLOT_ANALYTIC_Y) F(SLOT_ANALYTIC_Z)

#define PATH_INTS(F)                                                 \
  F(RAY_SKIP)        /* primitive that the ray starts on, or -1 */   \
  F(SLOT)                                                            \
  F(PIXEL_HASH)                                                      \
  F(SAMPLE_INDEX)                                                    \
  F(CAMERA_HIT)      /* direct: primitive that the camera sees */

#define LANE_INTS(F)                                  \
  F(HIT)             /* primitive hit, or -1 */       \
  F(ALIVE)                                            \
  F(SHADOW_SKIP)     /* primitive that the shadow ray starts on */ \
  F(SHADOW_CONTROLLED) /* CONTROLLED_*: whether its light goes into SHADOWED, not RADIANCE */ \
  F(FILM_X) F(FILM_Y) /* the path's pixel, while its camera ray is made */ \
  F(GOING) F(FINISHED) /* lists of lanes, while the block is compacted */

// clang-format on

#define ENUMERATE(name) name,
// Each ..._COUNT is where the next list starts.
enum {
  PATH_FLOATS(ENUMERATE) PATH_FLOAT_COUNT,
  BEFORE_CAMERA_RAY_ = PATH_FLOAT_COUNT - 1,
  CAMERA_RAY_FLOATS(ENUMERATE) PATH_AND_CAMERA_RAY_COUNT,
  BEFORE_SHADOW_ = PATH_AND_CAMERA_RAY_COUNT - 1,
  SHADOW_FLOATS(ENUMERATE) PLAIN_STATE_FLOATS,
  BEFORE_CONTROL_ = PLAIN_STATE_FLOATS - 1,
  CONTROL_FLOATS(ENUMERATE) STATE_FLOATS
};
enum {
  SLOT_FLOATS(ENUMERATE) PLAIN_SLOT_FLOATS,
  BEFORE_SLOT_CONTROL_ = PLAIN_SLOT_FLOATS - 1,
  SLOT_CONTROL_FLOATS(ENUMERATE) SLOT_FLOAT_COUNT
};
enum {
  PATH_INTS(ENUMERATE) PATH_INT_COUNT,
  BEFORE_LANE_ = PATH_INT_COUNT - 1,
  LANE_INTS(ENUMERATE) STATE_INTS
};
#undef ENUMERATE
// A light beneath the surface is in shadow whatever the shadow ray says; its closed form ignores that.
enum { CONTROLLED_NOT, CONTROLLED_SEEN, CONTROLLED_BENEATH };
#define REFERENCE_NORMAL_X CAMERA_DIRECTION_X

/// How many floats a path and a slot of a scene with these features need.
FN int state_floats(uint features) {
  return (features & FEATURE_POLYGONS) != 0u ? STATE_FLOATS : PLAIN_STATE_FLOATS;
}
FN int slot_floats(uint features) {
  return (features & FEATURE_POLYGONS) != 0u ? SLOT_FLOAT_COUNT : PLAIN_SLOT_FLOATS;
}

typedef struct {
  GLOBAL float* f;      ///< state_floats() * capacity
  GLOBAL int* i;        ///< STATE_INTS * capacity
  GLOBAL float* slots;  ///< slot_floats() * slot_capacity
  int capacity;         ///< paths under way at once, a multiple of LANES
  int slot_capacity;    ///< for the samples of the block's pixels and more, see slot_pixels()
  GLOBAL int* probe;  ///< 0, or for a block of one path: becomes the SOURCE_* of its first non-finite value,
                      ///< and the step
} Block;

// Read and write a vec3 whose x, y and z are consecutive fields.
#define LOAD3(f, capacity, field, lane)                                                   \
  make_vec3((f)[(field) * (capacity) + (lane)], (f)[((field) + 1) * (capacity) + (lane)], \
            (f)[((field) + 2) * (capacity) + (lane)])
#define STORE3(f, capacity, field, lane, v)           \
  do {                                                \
    (f)[(field) * (capacity) + (lane)] = (v).x;       \
    (f)[((field) + 1) * (capacity) + (lane)] = (v).y; \
    (f)[((field) + 2) * (capacity) + (lane)] = (v).z; \
  } while (0)

PENUMBRA_NAMESPACE_END
#endif
