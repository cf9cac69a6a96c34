// The state of many paths as a structure of arrays. Each field is one row of a table, which generates its
// storage, its accessors and its part in the compaction of a block. Fields that no feature of the scene needs
// have no storage.
#ifndef PENUMBRA_PATH_STATE_H
#define PENUMBRA_PATH_STATE_H
#include "kernels/features.h"
#include "kernels/intersect/surface_fields.h"
#include "kernels/scene_types.h"

PENUMBRA_NAMESPACE_BEGIN

// clang-format off
#define EVERY_SCENE FEATURE_ALL
#define NEVER 0u
#define LIGHT_THROUGH (FEATURE_NESTED | FEATURE_FLAT_GLASS)
#define THROUGH (LIGHT_THROUGH | FEATURE_LOOK_THROUGH)
#define SPLIT_LIGHT (FEATURE_DIRECT_LAYER | FEATURE_INDIRECT_LAYER)
// A field is needed by any of its features; with ALL_OF, only by all of them together.
#define ALL_OF(features) ((ulong)1 << 63 | (features))

#define LTC_PROJECTED ALL_OF(FEATURE_LTC | FEATURE_PROJECTED)
#define LTC_CONTROLLED ALL_OF(FEATURE_LTC | FEATURE_POLYGONS)
#define TINTS (FEATURE_PANES | FEATURE_FLAT_GLASS)
#define KEEPS_SURFACE (FEATURE_DIRECT | FEATURE_OCCLUSION)
#define KEPT_SURFACE_FIELD(X, type, name) X(type, surface_##name, KEEPS_SURFACE, KEEPS_SURFACE)
#define KEPT_UV_FIELD(X, type, name) X(type, surface_##name, ALL_OF(FEATURE_DIRECT | FEATURE_UV), FEATURE_DIRECT)

#define KEPT_INSTANCE_FIELD(X, type, name) X(type, surface_##name, FEATURE_INSTANCES, FEATURE_INSTANCES)
#define KEPT_COAT_FIELD(X, type, name) \
  X(type, surface_##name, ALL_OF(FEATURE_DIRECT | FEATURE_COAT_NORMALS), FEATURE_DIRECT)

// X(type, name, features that need it, features with which it is moved when a block is compacted). Types are
// float, int, bool and vec3. Fields that are not moved are valid within one step only.
#define PATH_FIELDS(X)                                                                                                \
  /* the next ray */                                                                                                  \
  X(vec3, ray_origin, EVERY_SCENE, EVERY_SCENE)                                                                       \
  X(vec3, ray_direction, EVERY_SCENE, EVERY_SCENE)      /* unit */                                                    \
  X(float, ray_tmax, EVERY_SCENE, EVERY_SCENE)          /* negative: no ray in this step */                           \
  X(int, ray_skip, EVERY_SCENE, EVERY_SCENE)            /* primitive that it starts on, or -1 */                      \
  X(int, ray_skip_instance, FEATURE_INSTANCES, FEATURE_INSTANCES) /* the instance of that primitive, or -1 */         \
  X(float, direction_pdf, EVERY_SCENE, EVERY_SCENE)     /* per solid angle; see DELTA_PDF; negative: see flat_glass.h */ \
  X(int, hit, EVERY_SCENE, NEVER)                       /* primitive that it hits, or -1 */                           \
  X(int, hit_instance, FEATURE_INSTANCES, NEVER)        /* the instance of that primitive, or -1 */                   \
  X(int, moving_hit, FEATURE_MOTION, NEVER)             /* what it hits of what moves, see block_motion.h */          \
  X(int, moving_instance, FEATURE_MOTION, NEVER)                                                                      \
  X(float, whole_tmax, FEATURE_MOTION, NEVER)                                                                         \
  /* the path */                                                                                                      \
  X(vec3, throughput, EVERY_SCENE, EVERY_SCENE)                                                                       \
  X(vec3, radiance, EVERY_SCENE, EVERY_SCENE)           /* found so far */                                            \
  X(vec3, direct, SPLIT_LIGHT, SPLIT_LIGHT)             /* of it before the second scattering: see note_direct */     \
  X(int, depth, EVERY_SCENE, EVERY_SCENE)               /* number of surfaces that scattered it */                    \
  X(float, eta, FEATURE_TRANSMISSION, FEATURE_TRANSMISSION) /* relative to the refractive index at the camera */      \
  X(int, slot, EVERY_SCENE, EVERY_SCENE)                /* the slot of its sample */                                  \
  X(int, pixel_hash, EVERY_SCENE, EVERY_SCENE)                                                                        \
  X(int, sample_index, EVERY_SCENE, EVERY_SCENE)                                                                      \
  X(float, time, FEATURE_MOTION, FEATURE_MOTION)        /* while the shutter is open: 0 to 1, see motion.h */         \
  X(bool, alive, EVERY_SCENE, NEVER)                    /* the path goes on after the step */                         \
  /* the surface where the ray started */                                                                             \
  X(vec3, left_normal, FEATURE_PROJECTED, FEATURE_PROJECTED)    /* its shading normal */                              \
  X(vec3, left_wo, LTC_PROJECTED, LTC_PROJECTED)                /* for its control lobes: see ReceiverLobes */        \
  X(vec3, left_matrix, LTC_PROJECTED, LTC_PROJECTED)                                                                  \
  X(float, left_specular, LTC_PROJECTED, LTC_PROJECTED)                                                               \
  X(vec3, left_place, FEATURE_LIGHT_TREE, FEATURE_LIGHT_TREE)   /* for its choice of lights: see LitPlace */          \
  X(vec3, left_facing, FEATURE_LIGHT_TREE, FEATURE_LIGHT_TREE)                                                        \
  X(float, left_finite_scale, FEATURE_LIGHT_TREE, FEATURE_LIGHT_TREE) /* see LightScales */                           \
  X(float, left_infinite_scale, FEATURE_LIGHT_TREE, FEATURE_LIGHT_TREE)                                               \
  X(float, left_pdf, FEATURE_EMITTING_MEDIA, NEVER)             /* of its direction, before it flies */               \
  X(bool, left_controlled, FEATURE_POLYGONS, FEATURE_POLYGONS)  /* its light from polygons has closed forms */        \
  X(int, chain, FEATURE_PHOTONS, FEATURE_PHOTONS)       /* CHAIN_*: the surfaces that scattered it */                 \
  /* rays that pass through surfaces: see block_see_through.h */                                                      \
  X(int, material, FEATURE_NESTED, FEATURE_NESTED)      /* leaf chosen at the hit, or -1: the side's material */      \
  X(vec3, kept_origin, THROUGH, FEATURE_NESTED)         /* start of the ray, before it passed surfaces */             \
  X(vec3, kept_direction, LIGHT_THROUGH, NEVER)                                                                       \
  X(float, kept_tmax, THROUGH, NEVER)                                                                                 \
  X(int, kept_skip, LIGHT_THROUGH, NEVER)                                                                             \
  X(int, kept_hit, THROUGH, NEVER)                                                                                    \
  X(int, kept_skip_instance, FEATURE_INSTANCES, NEVER)                                                                \
  X(int, kept_hit_instance, FEATURE_INSTANCES, NEVER)                                                                 \
  /* plates of glass: see flat_glass.h */                                                                             \
  X(int, glass, FEATURE_FLAT_GLASS, FEATURE_FLAT_GLASS) /* GLASS_* */                                                 \
  X(vec3, glass_direction, FEATURE_FLAT_GLASS, FEATURE_FLAT_GLASS) /* in which it left another surface */             \
  X(float, glass_pdf, FEATURE_FLAT_GLASS, FEATURE_FLAT_GLASS)   /* of that direction */                               \
  X(int, shadow_glass, FEATURE_FLAT_GLASS, NEVER)       /* boundaries that the shadow ray has passed; -1: it cannot */\
  /* media: see medium_stack.h and flight.h */                                                                        \
  X(int, media_low, FEATURE_MEDIA, FEATURE_MEDIA)       /* media at the path, on the ray's side of its surface */     \
  X(int, media_high, FEATURE_MEDIA, FEATURE_MEDIA)                                                                    \
  X(int, beyond_low, FEATURE_MEDIA, FEATURE_MEDIA)      /* behind the surface; under way: before the last boundary */ \
  X(int, beyond_high, FEATURE_MEDIA, FEATURE_MEDIA)                                                                   \
  X(int, hero, FEATURE_MEDIA, FEATURE_MEDIA)            /* the channel that samples distances */                      \
  X(vec3, channels, FEATURE_MEDIA, FEATURE_MEDIA)       /* ratios of the channels' densities; their mean is 1 */      \
  X(float, depth_left, FEATURE_MEDIA, NEVER)            /* optical depth left until it scatters */                    \
  X(float, way, FEATURE_MEDIA, NEVER)                   /* distance from ray start to last passed surface */          \
  X(vec3, boundary_normal, FEATURE_MEDIA, FEATURE_MEDIA)    /* of a surface near the path: see NearBoundary */        \
  X(float, boundary_depth, FEATURE_MEDIA, FEATURE_MEDIA)                                                              \
  X(float, boundary_offset, FEATURE_MEDIA, FEATURE_MEDIA)                                                             \
  X(float, boundary_clearance, FEATURE_MEDIA, FEATURE_MEDIA)                                                          \
  X(int, crossed, FEATURE_MEDIA, NEVER)                 /* the last boundary: see crossing_code; 0: none */           \
  X(int, contradiction, FEATURE_MEDIA, FEATURE_MEDIA)   /* 1 + first contradictory shape; 0: none; -1: unknown */     \
  X(int, shadow_low, FEATURE_MEDIA, NEVER)              /* media that the shadow ray is in */                         \
  X(int, shadow_high, FEATURE_MEDIA, NEVER)                                                                           \
  X(int, shadow_glow, FEATURE_EMITTING_MEDIA, NEVER)    /* the medium to a point of which it leads, or -1 */          \
  X(vec3, shadow_passes, FEATURE_MEDIA | TINTS, NEVER)  /* transmittance of media; then also the tint */              \
  X(vec3, shadow_densities, FEATURE_MEDIA, NEVER)       /* with which paths would pass those media */                 \
  X(vec3, shadow_tint, TINTS, NEVER)                    /* tint by glass */                                           \
  X(float, shadow_balance, FEATURE_MEDIA, NEVER)        /* its pdf by direction sampling over that by lights */       \
  /* interiors of materials: see interiors.h */                                                                       \
  X(int, inner, FEATURE_INTERIORS, FEATURE_INTERIORS)   /* of `depth`, how often it went in or scattered inside */    \
  X(vec3, inner_albedo, FEATURE_INTERIORS, FEATURE_INTERIORS) /* factor of the medium's, by where it went in */       \
  /* whitted: branches that are left when the path ends, see BRANCH_FIELDS */                                         \
  X(int, branch_place, FEATURE_WHITTED, FEATURE_WHITTED)   /* the lane where its branches are stored */               \
  X(int, branch_count, FEATURE_WHITTED, FEATURE_WHITTED)                                                              \
  X(int, revisit, FEATURE_WHITTED, FEATURE_WHITTED)        /* `more` of the branch that leads back, else 0 */         \
  /* direct light, occlusion: the surface that the camera sees, which all samples share */                            \
  SURFACE_HIT_FIELDS(KEPT_SURFACE_FIELD, X)                                                                           \
  SURFACE_UV_FIELDS(KEPT_UV_FIELD, X)                                                                                 \
  SURFACE_INSTANCE_FIELDS(KEPT_INSTANCE_FIELD, X)                                                                     \
  SURFACE_COAT_FIELDS(KEPT_COAT_FIELD, X)                                                                             \
  /* the shadow ray */                                                                                                \
  X(vec3, shadow_origin, EVERY_SCENE, NEVER)                                                                          \
  X(vec3, shadow_direction, EVERY_SCENE, NEVER)                                                                       \
  X(float, shadow_tmax, EVERY_SCENE, NEVER)             /* negative: no shadow ray */                                 \
  X(int, shadow_skip, EVERY_SCENE, NEVER)               /* primitive that it starts on, or -1 */                      \
  X(int, shadow_skip_instance, FEATURE_INSTANCES, NEVER) /* the instance of that primitive, or -1 */                  \
  X(vec3, shadow_radiance, EVERY_SCENE, NEVER)          /* its contribution if it is unoccluded */                    \
  X(float, shadow_transmittance, EVERY_SCENE, NEVER)    /* 0 to 1; negative: not known yet */                         \
  X(float, shadow_share, FEATURE_BENT, NEVER)           /* fraction that bumps let through */                         \
  X(int, shadow_controlled, FEATURE_POLYGONS, NEVER)    /* CONTROL_* */                                               \
  X(vec3, shadow_control, LTC_CONTROLLED, NEVER)           /* contribution to the control variate */                  \
  /* polygon lights with control variates: sums of shadow rays with and without shadows; closed forms */              \
  X(vec3, shadowed, FEATURE_POLYGONS, FEATURE_POLYGONS)                                                               \
  X(vec3, unshadowed, FEATURE_POLYGONS, FEATURE_POLYGONS)                                                             \
  X(vec3, analytic, FEATURE_POLYGONS, FEATURE_POLYGONS)                                                               \
  /* while camera rays are made, and while a block is compacted */                                                    \
  X(int, film_x, EVERY_SCENE, NEVER)                                                                                  \
  X(int, film_y, EVERY_SCENE, NEVER)                                                                                  \
  X(int, going, EVERY_SCENE, NEVER)                     /* a list of lanes */                                         \
  X(int, finished, EVERY_SCENE, NEVER)                  /* likewise */                                                \
  X(float, sort_buffer, FEATURE_MIXED_FAMILIES, NEVER)

// A branch that a path has left for later: its next ray or, if a surface has more direction samples to take,
// the ray that leads back to that surface.
#define BRANCH_FIELDS(F, a)                                            \
  F(a, vec3, origin)                                                   \
  F(a, vec3, direction)                                                \
  F(a, vec3, throughput)                                               \
  F(a, int, depth)                                                     \
  F(a, int, skip)       /* primitive that it starts on, or -1 */       \
  F(a, int, instance)   /* the instance of that primitive, or -1 */    \
  F(a, float, eta)      /* refractive index over that at the camera */ \
  F(a, int, pixel_hash)                                                \
  F(a, int, more)       /* 0: a branch of its own; else the number of samples left to take */
// A path's MAX_BRANCH_DEPTH branches are never moved: `branch_place` is the lane where they are, whatever the
// path's lane.
#define STACKED_FIELD(X, type, name) X(type, branch_##name, FEATURE_WHITTED, NEVER)
#define STACKED_FIELDS(X) BRANCH_FIELDS(STACKED_FIELD, X)

// The fields of a finished path's sample, indexed by its slot.
#define SLOT_FIELDS(X)                                                 \
  X(float, filter_weight, EVERY_SCENE, NEVER) /* of the sample */      \
  X(vec3, sample, EVERY_SCENE, NEVER)         /* radiance */           \
  X(vec3, albedo, FEATURE_LAYERS, NEVER)                               \
  X(vec3, normal, FEATURE_LAYERS, NEVER)                               \
  X(float, distance, FEATURE_LAYERS, NEVER)                            \
  X(float, coverage, FEATURE_COVERAGE, NEVER) /* 1 or 0 */             \
  X(int, contradiction, FEATURE_MEDIA, NEVER) /* as of paths */        \
  X(int, matte, FEATURE_MATTES, NEVER)        /* see record_mattes */  \
  X(vec3, shadowed, FEATURE_POLYGONS, NEVER)                           \
  X(vec3, unshadowed, FEATURE_POLYGONS, NEVER)                         \
  X(vec3, analytic, FEATURE_POLYGONS, NEVER)                           \
  X(vec3, position, FEATURE_POSITION_LAYER, NEVER)                     \
  X(vec3, uv, FEATURE_UV_LAYER, NEVER)        /* the third is 0 */     \
  X(vec3, geometric_normal, FEATURE_GEOMETRIC_NORMAL_LAYER, NEVER)     \
  X(float, shape, FEATURE_SHAPE_LAYER, NEVER) /* number of a shape */  \
  X(vec3, direct, FEATURE_DIRECT_LAYER, NEVER)                         \
  X(vec3, indirect, FEATURE_INDIRECT_LAYER, NEVER)                     \
  X(vec3, motion_before, FEATURE_MOTION_LAYER, NEVER) /* in pixels */  \
  X(vec3, motion_after, FEATURE_MOTION_LAYER, NEVER)
// clang-format on

/// Whether a scene with these features has a field that `needs` them; whether the field is moved.
FN bool is_stored(ulong features, ulong needs) {
  return needs >> 63 != 0 ? (~features & needs) << 1 == 0 : (features & needs) != 0;
}
FN bool is_moved(ulong features, ulong needs, ulong travels) {
  return is_stored(features, needs) && is_stored(features, travels);
}
// Whether the kernels are compiled for any scene that has the field.
#define MAY_STORE(needs)                                                       \
  ((ulong)(needs) >> 63 != 0 ? (~COMPILED_FEATURES & (ulong)(needs)) << 1 == 0 \
                             : (COMPILED_FEATURES & (ulong)(needs)) != 0)
#define MAY_MOVE(needs, travels) (MAY_STORE(needs) && MAY_STORE(travels))

// Whether a shadow ray's light goes into `radiance` (CONTROL_NONE), or into `shadowed` and `unshadowed`.
// CONTROL_BENEATH: the light is below the surface's horizon and in shadow whatever the shadow ray finds; its
// closed form ignores that.
enum { CONTROL_NONE, CONTROL_IN_SIGHT, CONTROL_BENEATH };

#define WORDS_float 1
#define WORDS_int 1
#define WORDS_bool 1
#define WORDS_vec3 3
#define POINTER_float GLOBAL float*
#define POINTER_int GLOBAL int*
#define POINTER_bool GLOBAL int*
#define POINTER_vec3 GLOBAL float*

#define STATE_POINTER(type, name, needs, travels) POINTER_##type name;
/// The start of each field's array. Component k of a vec3 is k * capacity further on.
typedef struct {
  PATH_FIELDS(STATE_POINTER)
  STACKED_FIELDS(STATE_POINTER)
  int capacity;  ///< number of paths under way at once, a multiple of LANES
} PathState;
typedef struct {
  SLOT_FIELDS(STATE_POINTER)
  int capacity;  ///< for the samples of the block's pixels, and more: see slot_pixels()
} SlotState;
#undef STATE_POINTER

#define STATE_WORDS(type, name, needs, travels) words += is_stored(features, needs) ? WORDS_##type : 0;
#define STACK_WORDS(type, name, needs, travels) \
  words += is_stored(features, needs) ? MAX_BRANCH_DEPTH * WORDS_##type : 0;
/// The 4-byte words that a path, and a sample, of a scene with these features take.
FN int path_words(ulong features) {
  int words = 0;
  PATH_FIELDS(STATE_WORDS)
  STACKED_FIELDS(STACK_WORDS)
  return words;
}
FN int slot_words(ulong features) {
  int words = 0;
  SLOT_FIELDS(STATE_WORDS)
  return words;
}
#undef STATE_WORDS
#undef STACK_WORDS

#define STATE_PLACE(type, name, needs, travels) \
  state.name = (POINTER_##type)words;           \
  words += is_stored(features, needs) ? (ulong)WORDS_##type * (ulong)capacity : 0u;
#define STACK_PLACE(type, name, needs, travels) \
  state.name = (POINTER_##type)words;           \
  words += is_stored(features, needs) ? (ulong)(MAX_BRANCH_DEPTH * WORDS_##type) * (ulong)capacity : 0u;
/// Places the fields in path_words() * capacity words.
FN PathState make_path_state(ulong features, GLOBAL uint* words, int capacity) {
  PathState state;
  PATH_FIELDS(STATE_PLACE)
  STACKED_FIELDS(STACK_PLACE)
  state.capacity = capacity;
  return state;
}
FN SlotState make_slot_state(ulong features, GLOBAL uint* words, int capacity) {
  SlotState state;
  SLOT_FIELDS(STATE_PLACE)
  state.capacity = capacity;
  return state;
}
#undef STATE_PLACE
#undef STACK_PLACE

// The accessors: get_throughput(paths, lane), set_throughput(paths, lane, value); get_slot_albedo(slots,
// slot) ...
#define PATH_ACCESSORS(type, name, needs, travels)                        \
  FN type get_##name(const PRIVATE PathState* paths, int i) {             \
    return LOAD_ENTRY_##type(paths->name, paths->capacity, i);            \
  }                                                                       \
  FN void set_##name(const PRIVATE PathState* paths, int i, type value) { \
    STORE_ENTRY_##type(paths->name, paths->capacity, i, value);           \
  }
PATH_FIELDS(PATH_ACCESSORS)
#undef PATH_ACCESSORS
#define SLOT_ACCESSORS(type, name, needs, travels)                             \
  FN type get_slot_##name(const PRIVATE SlotState* slots, int i) {             \
    return LOAD_ENTRY_##type(slots->name, slots->capacity, i);                 \
  }                                                                            \
  FN void set_slot_##name(const PRIVATE SlotState* slots, int i, type value) { \
    STORE_ENTRY_##type(slots->name, slots->capacity, i, value);                \
  }
SLOT_FIELDS(SLOT_ACCESSORS)
#undef SLOT_ACCESSORS

#define KEPT_SURFACE_GET(a, type, name) s.name = get_surface_##name(paths, i);
#define KEPT_SURFACE_SET(a, type, name) set_surface_##name(paths, i, s.name);
// clang-format off
/// The surface that a path of the direct or occlusion integrator keeps, without and with texture coordinates.
FN Surface kept_surface(const PRIVATE PathState* paths, int i) {
  Surface s;
  SURFACE_HIT_FIELDS(KEPT_SURFACE_GET, )
  return without_uv(s);
}
FN void keep_surface(const PRIVATE PathState* paths, int i, Surface s) {
  SURFACE_HIT_FIELDS(KEPT_SURFACE_SET, )
}
FN Surface with_kept_uv(const PRIVATE PathState* paths, int i, Surface s) {
  SURFACE_UV_FIELDS(KEPT_SURFACE_GET, )
  return s;
}
FN void keep_uv(const PRIVATE PathState* paths, int i, Surface s) {
  SURFACE_UV_FIELDS(KEPT_SURFACE_SET, )
}
// clang-format on
#undef KEPT_SURFACE_GET
#undef KEPT_SURFACE_SET

LANE_RECORD(Branch, Branches, branch, BRANCH_FIELDS)

// clang-format off
#define STACKED_AT(type, name) paths->branch_##name + level* WORDS_##type * paths->capacity
#define STACKED_GET(a, type, name) \
  b.name = LOAD_ENTRY_##type((STACKED_AT(type, name)), paths->capacity, place);
#define STACKED_SET(a, type, name) \
  STORE_ENTRY_##type((STACKED_AT(type, name)), paths->capacity, place, b.name);
/// Branch `level`, from 0 on, of the path whose branches are at lane `place`.
FN Branch stacked_branch(const PRIVATE PathState* paths, int place, int level) {
  Branch b;
  BRANCH_FIELDS(STACKED_GET, )
  return b;
}
FN void stack_branch(const PRIVATE PathState* paths, int place, int level, Branch b) {
  BRANCH_FIELDS(STACKED_SET, )
}
// clang-format on
#undef STACKED_AT
#undef STACKED_GET
#undef STACKED_SET

// How many rays were traced: a measure of work that is the same on every machine.
typedef struct {
  ulong rays;         ///< of paths from the camera, without those towards lights
  ulong shadow_rays;  ///< towards lights
  ulong photon_rays;
} TracedRays;

typedef struct {
  PathState paths;
  SlotState slots;
  GLOBAL int* probe;  ///< 0, or for a block of one path: receives the SOURCE_* of its first non-finite value,
                      ///< and the step
  GLOBAL TracedRays* traced;  ///< 0, or receives what is traced, added to what is there
} Block;

/// `path_memory` has path_words(features) * capacity words, `slot_memory` slot_words(features) *
/// slot_capacity.
FN Block make_block(ulong features, GLOBAL uint* path_memory, int capacity, GLOBAL uint* slot_memory,
                    int slot_capacity) {
  Block block;
  block.paths = make_path_state(features, path_memory, capacity);
  block.slots = make_slot_state(features, slot_memory, slot_capacity);
  block.probe = 0;
  block.traced = 0;
  return block;
}

PENUMBRA_NAMESPACE_END
#endif
