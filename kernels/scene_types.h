// All structs that host and device share, each generated from one field list. Fields are scalars and packed
// vec3 only, so that all compilers use the same layout. A test compares the offsets that an OpenCL device
// reports with the host's.
#ifndef PENUMBRA_SCENE_TYPES_H
#define PENUMBRA_SCENE_TYPES_H
#include "kernels/bsdf/families.h"
#include "kernels/features.h"
#include "kernels/light/light_kinds.h"
#include "kernels/math/vec3.h"
#include "kernels/photon/photon_fields.h"
#include "kernels/texture/texture_kinds.h"

PENUMBRA_NAMESPACE_BEGIN

#define INTERSECTOR_PORTABLE 0
#define INTERSECTOR_EMBREE 1

#define SAMPLER_INDEPENDENT 0
#define SAMPLER_STRATIFIED 1
#define SAMPLER_HALTON 2
#define SAMPLER_SOBOL 3

#define FILTER_BOX 0
#define FILTER_TENT 1
#define FILTER_TABULATED 2

#define INTEGRATOR_DIRECT 0
#define INTEGRATOR_PATH 1
#define INTEGRATOR_WHITTED 2
#define INTEGRATOR_OCCLUSION 3

#define SAMPLING_BSDF_ONLY 0
#define SAMPLING_EMITTER_ONLY 1
#define SAMPLING_MIS 2

// Path integrator: which light is kept, that found by direction (BSDF) samples or that found by emitter
// samples.
#define TECHNIQUE_ALL 0
#define TECHNIQUE_BSDF 1
#define TECHNIQUE_EMITTER 2

#define CHOICE_POWER 0
#define CHOICE_ANALYTIC 1
#define CHOICE_TREE 2

// How three quantities make an estimate: the samples H of polygon lights, the same samples without shadows W,
// and the closed form G of the unshadowed light.
#define ESTIMATOR_SAMPLES 0  // H alone
#define ESTIMATOR_ALPHA 1    // alpha G + (H - alpha W)
#define ESTIMATOR_AUTO 2     // as ESTIMATOR_ALPHA, with alpha from other samples of the pixel

// What the camera sees in place of an emitter: its light, a surface without emission, or what is behind it.
// HIDE_MARKED: a surface without emission, of those that are UNSEEN_BY_CAMERA.
#define HIDE_MARKED -1
#define HIDE_NOTHING 0
#define HIDE_LIGHT 1
#define HIDE_LOOK_THROUGH 2

// What does not find a light.
#define UNSEEN_BY_RAYS 1    // rays do not meet it, so that only samples of the light find it
#define UNSEEN_BY_CAMERA 2  // camera rays do not add its light

// Photon maps of the path integrator.
#define PHOTONS_NONE 0
#define PHOTONS_PROGRESSIVE 1  // a new map of all surfaces every few samples, with shrinking radii
#define PHOTONS_FIXED 2        // one global map and one caustic map for the image

// Where paths of the camera take indirect light from photons.
#define GATHER_FIRST 0     // at the first diffuse surface, where they end
#define GATHER_SECOND 1    // one bounce later; caustics at the first
#define GATHER_CAUSTICS 2  // caustics alone, at every diffuse surface; paths find other light

#define HEURISTIC_BALANCE 0
#define HEURISTIC_POWER 1

#define DIRECTION_BSDF 0
#define DIRECTION_COSINE 1
#define DIRECTION_UNIFORM 2
#define DIRECTION_SPHERE 3  // occlusion integrator only: uniform in the sphere
#define DIRECTION_LOBE 4    // occlusion integrator only: a lobe about the mirror direction

#define WEIGHTING_COSINE 0
#define WEIGHTING_UNIFORM 1
#define WEIGHTING_NORMALS 2 /* no rays: the shading normal is shown instead */

#define EMITTER_AREA 0
#define EMITTER_SOLID_ANGLE 1
#define EMITTER_PROJECTED 2

#define QUADRIC_SPHERE 0
#define QUADRIC_DISK 1
#define QUADRIC_CYLINDER 2
// Pieces of curves, see intersect/curve.h; the last one is a ribbon with the normals of a cylinder.
#define QUADRIC_ROUND 3
#define QUADRIC_ROUND_BALLS 4
#define QUADRIC_RIBBON 5
#define QUADRIC_CYLINDRICAL_RIBBON 6

// Which rays pass through a material: none, all, or a random share (where some leaves of its tree pass rays).
#define PASSES_NONE 0
#define PASSES_ALL 1
#define PASSES_SOME 2
#define MOST_PASSING_LEAVES 4096  // of a material tree: shadow rays visit them all

#define MAX_MEDIA 255             // including record 0, the vacuum
#define MAX_VOLUME_CELLS 1048576  // along one axis: floats hold cell indices exactly

#define PHASE_HG 0  // isotropic where g is 0
#define PHASE_RAYLEIGH 1
#define PHASE_LOBES 4  // in every mixture of phase functions; unused ones have weight 0

#define BEND_NONE 0
#define BEND_NORMAL_MAP 1
#define BEND_BUMP_MAP 2

#define NO_MATTE 0           // matte number of rays that hit nothing
#define MAX_MATTES 16777215  // floats hold numbers up to here exactly
#define MAX_SHAPES 16777215  // likewise

#define BVH_WIDTH 8               // children of a node, or primitives of a leaf
#define MAX_DIRECT_SAMPLES 65536  // emitter or BSDF samples per camera ray
#define LIGHT_PROBABILITY_STEPS \
  16777216.0f                 // 2^24: probabilities in the light hierarchy are multiples of its inverse
#define LIGHT_CUT 16          // largest number of nodes where descents through the light hierarchy may start
#define MAX_PHOTONS 16777216  // largest number of photons that are emitted for a map
#define MOST_MOTION_STEPS 64  // of what moves while the shutter is open
#define MAX_BRANCH_DEPTH 8    // largest number of surfaces in a row at which a path may branch
#define FILTER_CELLS 256
#define LTC_SIZE 32  // rows and columns of the table of linearly transformed cosines
#define FILTER_TABLE_SIZE (2 * FILTER_CELLS + 1)  // knots and weights, see filter.h

// The origin is the centre of the scene. The builder subtracts the centre in double precision before it
// converts to float.
#define TRIANGLE_FIELDS(F)                                                        \
  F(vec3, p0)                                                                     \
  F(vec3, p1)                                                                     \
  F(vec3, p2)     /* counter-clockwise as seen from the front */                  \
  F(int, front)   /* material of the side that (p1 - p0) x (p2 - p0) points to */ \
  F(int, back)    /* material of the other side */                                \
  F(int, light)   /* index of its light, or -1; it emits from the front */        \
  F(int, normals) /* index of its vertex normals, or -1 for a flat face */

#define VERTEX_NORMALS_FIELDS(F) \
  F(vec3, n0)                    \
  F(vec3, n1)                    \
  F(vec3, n2)

// Texture coordinates of a triangle's vertices; barycentric coordinates if the mesh has none.
#define VERTEX_UVS_FIELDS(F) \
  F(float, u0)               \
  F(float, v0)               \
  F(float, u1)               \
  F(float, v1)               \
  F(float, u2)               \
  F(float, v2)

// Tangents at a triangle's vertices, as coordinates along p1 - p0, along p2 - p0 and along its unit normal,
// so that they follow it as it moves. Where all are 0, the tangent is that of the texture coordinates.
#define VERTEX_TANGENTS_FIELDS(F) \
  F(vec3, t0)                     \
  F(vec3, t1)                     \
  F(vec3, t2)                     \
  F(float, hand) /* of its normal maps: the bitangent is hand * (normal x tangent) */

// A piece of a curve has its ends in `center` and `x_axis`, its radii there in `radius` and `length`, its
// unit tangents in `normal` and `y_axis`, of which the second is as long as the curve's parameter grows, from
// `orientation`.
#define QUADRIC_FIELDS(F)                                                                             \
  F(vec3, center) /* cylinder: centre of its first end */                                             \
  F(vec3, normal) /* unit; disk: front normal, sphere: pole of texture coordinates, cylinder: axis */ \
  F(float, radius)                                                                                    \
  F(float, length)      /* of a cylinder; else 1 */                                                   \
  F(vec3, x_axis)       /* unit; with the normal they form an orthogonal, possibly mirrored, frame */ \
  F(vec3, y_axis)       /* ... for texture coordinates */                                             \
  F(float, orientation) /* sphere, cylinder: 1 if the outside is the front, else -1 */                \
  F(int, kind)          /* QUADRIC_* */                                                               \
  F(int, front)                                                                                       \
  F(int, back)                                                                                        \
  F(int, light)

// An instance of a group of shapes. The group's triangles and quadrics are relative to the group's own
// centre. Its point p lies at x p.x + y p.y + z p.z + at in the scene. The rows are those of the inverse
// matrix.
#define INSTANCE_FIELDS(F) \
  F(vec3, x)               \
  F(vec3, y)               \
  F(vec3, z)               \
  F(vec3, at)              \
  F(vec3, row_x)           \
  F(vec3, row_y)           \
  F(vec3, row_z)           \
  F(int, group)

// How a record moves while the shutter is open: at `steps` + 1 evenly spaced times from 0 (the shutter opens)
// to 1 (it is closed everywhere) it is in the states first, first + stride ...; between them, it moves
// linearly. With FEATURE_MOTION_LAYER, the states after those are at the middle of the frame before and of
// the next one. See motion/motion.h.
#define MOTION_FIELDS(F) \
  F(int, first)          \
  F(int, stride)         \
  F(int, steps) /* 0: it does not move, and has no states */

// The states of what moves. A quadric's and the camera's are whole records.
#define TRIANGLE_STATE_FIELDS(F)                  \
  F(vec3, p0)                                     \
  F(vec3, p1)                                     \
  F(vec3, p2)                                     \
  F(vec3, n0) /* vertex normals, if it has any */ \
  F(vec3, n1)                                     \
  F(vec3, n2)
#define INSTANCE_STATE_FIELDS(F) \
  F(vec3, x)                     \
  F(vec3, y)                     \
  F(vec3, z)                     \
  F(vec3, at)
// As in Light; the axes are those of its Beam.
#define LIGHT_STATE_FIELDS(F) \
  F(vec3, p0)                 \
  F(vec3, p1)                 \
  F(vec3, p2)                 \
  F(vec3, x)                  \
  F(vec3, y)                  \
  F(vec3, z)

// The one record of the scene's shutter. Of the triangles, quadrics and instances, the last ones move, those
// from `still_triangles` and so on.
#define SHUTTER_FIELDS(F)                                                                         \
  F(int, still_triangles)                                                                         \
  F(int, still_quadrics)                                                                          \
  F(int, still_instances)                                                                         \
  F(int, camera_steps) /* 0: the camera does not move */                                          \
  F(float, exposure)   /* share of the whole time for which a row of the film is exposed */       \
  F(float, rolling)    /* share by which the last row's exposure starts later than the first's */ \
  F(int, curve_knots)  /* of the shutter's curve, at least 2, evenly spaced */

// A node of the hierarchy of what moves. The box of child k at time t is [low + t low_speed, high + t
// high_speed], for t in [begin, end]; at other times the child is not there. Child k is a node if child[k] >=
// 0, else leaf ~child[k]. An empty slot is any leaf whose `end` is before its `begin`.
#define MOTION_NODE_FIELDS(F)        \
  F(float, low[3][BVH_WIDTH])        \
  F(float, high[3][BVH_WIDTH])       \
  F(float, low_speed[3][BVH_WIDTH])  \
  F(float, high_speed[3][BVH_WIDTH]) \
  F(float, begin[BVH_WIDTH])         \
  F(float, end[BVH_WIDTH])           \
  F(int, child[BVH_WIDTH])

// What moves in a leaf: an instance, or else a primitive; an unused slot has -1 for both. A leaf of
// primitives has a record for each of their states from `first_step` to `last_step` of `steps`, in which
// alone traversal looks for it: coordinate k of vertex v of triangle j is p[v][k][j].
#define MOTION_LEAF_FIELDS(F)  \
  F(float, p[3][3][BVH_WIDTH]) \
  F(int, primitive[BVH_WIDTH]) \
  F(int, instance[BVH_WIDTH])  \
  F(int, first_step)           \
  F(int, last_step)            \
  F(int, steps)

// A range of consecutive primitives. In a scene with instances, group 0 holds the shapes that are not
// instanced; the other groups are placed by instances.
#define PRIMITIVE_GROUP_FIELDS(F)                        \
  F(int, root) /* root node of its subtree of the BVH */ \
  F(int, first_triangle)                                 \
  F(int, triangle_count)                                 \
  F(int, first_quadric)                                  \
  F(int, quadric_count)

// The fields of a material's closure (BSDF lobes). Material 0 absorbs everything.
#define MATERIAL_FIELD(F, type, name) F(type, name)
#define MATERIAL_TEXTURE(F, type, name) F(int, name##_texture) /* index, or -1 for the constant value */
// All material parameters that may have a texture: those of the closure, and four more.
#define MATERIAL_TEXTURES(F, a) \
  TEXTURED_FIELDS(F, a)         \
  F(a, float, weight)           \
  F(a, int, bend)               \
  F(a, int, coat_bend)          \
  F(a, int, turn)
// A material is a tree of BSDFs. A leaf scatters by its closure. An inner node chooses `first` or `second` at
// random at each point; both have lower indices than the node, or are -1: rays pass through. A texture may
// bend (normal map, bump map) a leaf's shading normal, and another turn its tangent.
#define MATERIAL_TREE_FIELDS(F)                                                                      \
  F(int, passes)         /* PASSES_* */                                                              \
  F(int, passing_leaves) /* leaves of the tree that let rays pass, 0 to MOST_PASSING_LEAVES */       \
  F(int, first)          /* index of a material, or -1 */                                            \
  F(int, second)         /* likewise; -1 in a leaf, whose `branches` is 0 */                         \
  F(int, branches)       /* 1: an inner node */                                                      \
  F(float, weight)       /* probability of `second`; textured values are clamped to [0, 1] */        \
  F(int, bend)           /* BEND_*: what bends the normal of a leaf */                               \
  F(float, bend_scale)   /* strength, see bend_normal.h; negative: bumps seen from the other side */ \
  F(float, bend_step)    /* difference of texture coordinates at which heights are compared */       \
  F(int, bend_shadows)   /* 1: bumps shadow each other, see bump_shadow */                           \
  F(int, coat_bend)      /* BEND_*: what bends the normal of a coat with OPENPBR_OWN_COAT */         \
  F(float, coat_bend_scale)                                                                          \
  F(float, coat_bend_step)                                                                           \
  F(int, turn)          /* 1: the tangent of a leaf is turned; -1: mirrored; else 0 */               \
  F(float, turn_cosine) /* of the angle */                                                           \
  F(float, turn_sine)                                                                                \
  F(float, pane)       /* relative index of a thin pane, which rays pass at random; else 0 */        \
  F(int, flat_glass)   /* 1: glass of plates, see flat_glass.h */                                    \
  F(vec3, channel_ior) /* relative refractive index of each channel if they differ, else 0 */

#define MATERIAL_FIELDS(F)               \
  CLOSURE_FIELDS(MATERIAL_FIELD, F)      \
  MATERIAL_TEXTURES(MATERIAL_TEXTURE, F) \
  MATERIAL_TREE_FIELDS(F)

// A participating medium. Record 0 is vacuum, with extinction 0. See medium/flight.h.
#define MEDIUM_FIELDS(F)                                                                                   \
  F(vec3, extinction)   /* per scene unit */                                                               \
  F(vec3, albedo)       /* single-scattering albedo */                                                     \
  F(int, material)      /* index of a material of FAMILY_PHASE: its phase function */                      \
  F(int, density)       /* index of a volume that scales the extinction, 0 outside of its box; or -1 */    \
  F(int, albedo_grid)   /* index of a volume that scales the albedo, or -1 */                              \
  F(vec3, emission)     /* radiance per scene unit */                                                      \
  F(int, emission_grid) /* index of a volume that scales the emission, 0 outside of its box; or -1 */      \
  F(int, emission_by_density) /* 1: the density scales it, too; 0 without density; 1 without grid but with \
                                 density */                                                                \
  F(int, light)               /* index of the light that samples its emission, or -1 */                    \
  F(int, interior)            /* 1: that of a material, which shadow rays do not enter: see interiors.h */ \
  F(int, exit)         /* material that its surface has for light from inside; -1: the surface's own */    \
  F(int, albedo_curve) /* start of the curve by which its albedo follows the colour, or -1 */

// A grid of numbers in space, see medium/volume.h.
#define VOLUME_FIELDS(F)                                                                          \
  F(vec3, corner) /* lower corner of cell (0, 0, 0) */                                            \
  F(vec3, row_x)  /* rows of the matrix from offsets from the corner to cell coordinates */       \
  F(vec3, row_y)                                                                                  \
  F(vec3, row_z)                                                                                  \
  F(int, nx)                                                                                      \
  F(int, ny)                                                                                      \
  F(int, nz)                                                                                      \
  F(int, channels)       /* 1 or 3 */                                                             \
  F(int, nearest)        /* 1: constant in each cell; 0: interpolated between cell centres */     \
  F(int, fades)          /* 1: interpolated towards 0 outside of the grid; 0: constant there */   \
  F(int, first_value)    /* index in volume_values; x fastest, all channels of a cell together */ \
  F(int, first_majorant) /* index in majorants, x fastest: maxima of blocks of MAJORANT_CELLS^3 cells */

// One of the PHASE_LOBES lobes of a medium's phase function, which is a mixture.
#define PHASE_LOBE_FIELDS(F)                                          \
  F(int, kind)     /* PHASE_* */                                      \
  F(float, g)      /* mean cosine of Henyey-Greenstein, in (-1, 1) */ \
  F(float, weight) /* weight in the mixture; the weights sum to 1 */

// A cluster of lights that illuminate media, for equiangular sampling: see medium/equiangular.h.
#define FLIGHT_CENTRE_FIELDS(F)                     \
  F(vec3, place)                                    \
  F(float, size)  /* extent of the light cluster */ \
  F(float, below) /* chosen by numbers below this and not below those of the previous centres */

// The boundary between two media at a shape's surface.
#define BOUNDARY_FIELDS(F)                                                                     \
  F(int, interior) /* index of the medium behind the front side */                             \
  F(int, exterior) /* index of the medium before the front side; -1: the surrounding medium */ \
  F(int, shape)    /* index of the shape in the scene, for messages; -1: none is told */

#define LIGHT_FIELDS(F)                                                                                 \
  F(vec3, radiance) /* radiance; point, spot: radiant intensity; directional: irradiance */             \
  F(vec3, p0) /* triangle vertex, rectangle corner, centre (cylinder: of its first end), or position */ \
  F(vec3, p1) /* triangle vertex, next corner; disk: front normal; cylinder: axis; directional, sun:    \
                 direction (unit) */                                                                    \
  F(vec3, p2) /* triangle vertex, previous corner; others: (radius, orientation, length) */             \
  F(float, area)                                                                                        \
  F(int, sampling)  /* EMITTER_* */                                                                     \
  F(int, two_sided) /* 1: also emits from the back */                                                   \
  F(int, unseen)    /* UNSEEN_*, or 0 */                                                                \
  F(int, polygon)   /* index of the polygon light that it is part of, or -1 */                          \
  F(float, pmf)     /* probability of choosing this light */                                            \
  F(int, start)     /* choice by power: the first of its LIGHT_PROBABILITY_STEPS */                     \
  F(int, kind)      /* LIGHT_* */                                                                       \
  F(int, texture)   /* index of the texture that scales its radiance, or -1 */                          \
  F(int, grid)      /* start of its sampling distribution in the light grids, or -1 */                  \
  F(int, grid_side)                                                                                     \
  F(float, spread) /* flat lights: tangent of half the cone that they shine into; 0: of 180 degrees */  \
  F(float, gain)   /* the factor with it, see light_spread.h */                                         \
  F(int, beam)     /* index of the beam of a spot light or projector, or of the glow of a medium */

// A node of the light hierarchy, see light_tree.h. Its lights are within the box. Their axes (normals)
// deviate from the node's axis by at most the angle of cosine cos_o. Each emits within the angle of cosine
// cos_e about its axis, in proportion to the cosine of that angle. A node of infinite lights has no position:
// its axes are directions of travel and its intensity is irradiance.
#define LIGHT_NODE_FIELDS(F)                                                                                 \
  F(vec3, center)                                                                                            \
  F(vec3, half_size) /* of the bounding box */                                                               \
  F(vec3, axis)      /* unit */                                                                              \
  F(float, radius)   /* of the bounding sphere */                                                            \
  F(float, inverse_radius)                                                                                   \
  F(float, cos_o)                                                                                            \
  F(float, sin_o)                                                                                            \
  F(float, cos_e)                                                                                            \
  F(float, intensity) /* sum over its lights, along their axes; in the hierarchy's units */                  \
  F(int, flags)       /* LIGHTS_* */                                                                         \
  F(int, child)  /* index of the first of two neighbouring children; in a leaf ~light, or ~(first member) */ \
  F(int, lights) /* number of lights in a leaf (several: it has members); 0: an inner node */
#define LIGHTS_TWO_SIDED 1 /* they also emit along the negative axis */
#define LIGHTS_INFINITE 2  /* all of its lights are at infinity */

// One of the lights of a leaf that has several.
#define LIGHT_MEMBER_FIELDS(F) \
  F(int, light)                \
  F(int, start) /* sum of the LIGHT_PROBABILITY_STEPS of the members before it in the leaf */

// An environment map, see envmap_light.h.
#define ENVIRONMENT_MAP_FIELDS(F) \
  F(int, width)                   \
  F(int, height)                  \
  F(float, covered) /* what directions of BSDF samples cover of a texel's sum, see envmap_weight */

// The directions into which a spot light or projector emits, see delta_lights.h.
#define BEAM_FIELDS(F)                                                                                \
  F(vec3, x) /* unit axes of the light's frame, which may be mirrored */                              \
  F(vec3, y)                                                                                          \
  F(vec3, z)       /* centre of the beam */                                                           \
  F(float, u_by_x) /* texture coordinates: 1/2 + u_by_x x / z and 1/2 + v_by_y y / z */               \
  F(float, v_by_y)                                                                                    \
  F(int, falloff)         /* SPOT_* */                                                                \
  F(float, beam_width)    /* spot: full intensity within it; linear: an angle, else 1 - its cosine */ \
  F(float, cutoff)        /* spot: no light beyond it; in the same measure */                         \
  F(float, inverse_width) /* 1 / (cutoff - beam_width), or 0 if they are equal */

// A medium that emits, as a light: see light/medium_light.h.
#define GLOW_FIELDS(F)                                                                       \
  F(vec3, cell_x) /* the axes of a cell of its volume, in the scene */                       \
  F(vec3, cell_y)                                                                            \
  F(vec3, cell_z)                                                                            \
  F(float, by_area)   /* the volume of such a cell over the light's area */                  \
  F(int, medium)      /* index of the medium */                                              \
  F(int, volume)      /* index of the volume that varies its emission, or is around it */    \
  F(int, side)        /* of a block, in cells; at the upper ends of the volume it is less */ \
  F(int, first_block) /* in the table of blocks */                                           \
  F(int, blocks)

// A block of cells, the (x, y, z)-th along the axes. It is chosen by numbers from `below` to that of the
// glow's next block, or to 1.
#define GLOW_BLOCK_FIELDS(F) \
  F(int, x)                  \
  F(int, y)                  \
  F(int, z)                  \
  F(float, below) /* a multiple of 1 / LIGHT_PROBABILITY_STEPS */

// How a spot light falls off between beam width and cutoff: linearly in the angle (Mitsuba), as 3t^2 - 2t^3
// of the cosine (pbrt), or as t^2 of the cosine (glTF).
#define SPOT_LINEAR 0
#define SPOT_SMOOTHSTEP 1
#define SPOT_SQUARED 2

// The primitives of a light: one triangle, the two triangles of a rectangle, or a quadric; -1: none.
#define LIGHT_TRIANGLES_FIELDS(F)                                 \
  F(int, first)                                                   \
  F(int, second)  /* equal to `first` if there is one triangle */ \
  F(int, quadric) /* index of its quadric, or -1 */

// The vertex colours of a triangle, for mesh_attribute textures.
#define VERTEX_COLOURS_FIELDS(F) \
  F(vec3, c0)                    \
  F(vec3, c1)                    \
  F(vec3, c2)

// A planar light: coplanar triangles (or one rectangle) with equal radiance that face the same side, merged
// into their outline. The cost of the closed form depends on the outline only.
#define POLYGON_FIELDS(F)                                                             \
  F(vec3, radiance)                                                                   \
  F(int, two_sided) /* 1: also emits from the back */                                 \
  F(float, area)                                                                      \
  F(float, size)       /* largest distance between two vertices, or an upper bound */ \
  F(int, first_corner) /* start of the outline in the table of polygon corners */     \
  F(int, corner_count)                                                                \
  F(int, first_light) /* first of its parts, which are consecutive lights */          \
  F(int, light_count)

// A corner of an outline. Each closed loop repeats its first corner at its end. Seen from the front, the
// inside is to the left of every edge: outer loops are counter-clockwise, holes clockwise.
#define POLYGON_CORNER_FIELDS(F) \
  F(vec3, p)                     \
  F(int, starts) /* 1: a loop starts here; no edge joins it to the previous corner */

// The edges of a light of constant radiance in one pixel of the camera's image, see camera/light_edges.h.
// There is one record for each such pixel and radiance, in the order of x within a row.
#define LIGHT_EDGE_PIXEL_FIELDS(F)                                                                \
  F(vec3, radiance) /* difference between the light's radiance and that beside it */              \
  F(float, share)   /* filter-weighted fraction of the pixel that the light covers, unoccluded */ \
  F(int, x)                                                                                       \
  F(int, first_edge)                                                                              \
  F(int, edge_count)

// The media at a light, for photons that leave it: a MediumStack.
#define LIGHT_MEDIA_FIELDS(F) \
  F(uint, low)                \
  F(uint, high)

// A part of an edge within the filter's support of a pixel, relative to the pixel's centre, in filter radii.
// At y in [y0, y1) or [y1, y0) it is at x0 + slope (y - y0). The light is at smaller x where y1 > y0, else at
// larger x.
#define LIGHT_EDGE_FIELDS(F) \
  F(float, x0)               \
  F(float, y0)               \
  F(float, y1)               \
  F(float, slope)

// An inner node of the wide BVH. Child k is a node if child[k] >= 0, else leaf ~child[k]. An empty slot is
// any leaf with an inverted box. Leaf numbers below FIRST_QUADRIC_LEAF are triangle leaves, then come quadric
// leaves, from FIRST_INSTANCE_LEAF on instances, so that a tree's nodes are the same whatever other trees
// there are. Only the subtree of node 0 has instances.
#define BVH_NODE_FIELDS(F)                                           \
  F(float, bounds[6][BVH_WIDTH]) /* minimum x, y, z, then maximum */ \
  F(int, child[BVH_WIDTH])

// The triangles of a leaf. p[v][axis] holds a coordinate of vertex v; unused slots have primitive -1.
#define TRIANGLE_LEAF_FIELDS(F) \
  F(float, p[3][3][BVH_WIDTH])  \
  F(int, primitive[BVH_WIDTH])

#define QUADRIC_LEAF_FIELDS(F) F(int, primitive[BVH_WIDTH])

// A linearly transformed cosine (Heitz et al. 2016) that fits the microfacet reflection of roughness alpha
// for a wo with cosine c and sine s. It is tilted from the mirror direction towards the normal by an angle of
// sine s * lean. Let q be the tangent of wo's angle that remains. In the plane z = 1 the lobe is centred at
// (q, 0), and its half-widths are 2 alpha (1 + q^2) width_x and 2 alpha width_y. Row i is roughness (i /
// (LTC_SIZE - 1))^2, column j is c = (j / (LTC_SIZE - 1))^2.
#define LTC_CELL_FIELDS(F)                                                              \
  F(float, lean)                                                                        \
  F(float, width_x)                                                                     \
  F(float, width_y)                                                                     \
  F(float, albedo)  /* directional albedo of the reflection without its Fresnel term */ \
  F(float, schlick) /* mean of (1 - cos)^5 over the lobe, cos at the microfacets */

#define CORNER_FIELDS(F) \
  F(int, v0)             \
  F(int, v1)             \
  F(int, v2)

// Panoramas, and their coordinates on the film to the left and upwards.
enum {
  PANORAMA_NONE,
  PANORAMA_EQUIRECTANGULAR,  // longitude and latitude, in turns
  PANORAMA_CYLINDRICAL,      // longitude in turns, height on a cylinder of radius 1
  PANORAMA_EQUIDISTANT,      // the angle off the axis, in turns, is the radius
  PANORAMA_EQUISOLID,        // the sine of half that angle is
  PANORAMA_EQUAL_AREA        // the square of equal_area_direction, from -1 to 1
};

// The camera. Lengths are in scene units. The fields from `parallel` on are only used with FEATURE_CAMERA,
// see lens_camera.h.
#define CAMERA_FIELDS(F)                                                                            \
  F(vec3, origin)                                                                                   \
  F(vec3, x) /* from the axis to the left edge of the film at distance 1 */                         \
  F(vec3, y) /* ... to the top edge */                                                              \
  F(vec3, z) /* unit viewing direction */                                                           \
  F(float, near_clip)                                                                               \
  F(float, far_clip)                                                                                \
  F(float, parallel) /* 1: rays through the lens centre are parallel to z; x, y: half the film's */ \
                     /* size. 0: those rays meet at the origin */                                   \
  F(float, offset_x) /* of the axis from the film's centre, to the left, in half widths */          \
  F(float, offset_y) /* ... upwards, in half heights */                                             \
  F(float, lens_radius)                                                                             \
  F(float, blades)     /* number of corners of the aperture; 0: a disk */                           \
  F(float, blade_turn) /* angle from x towards y to the first corner, in turns, 0 to 1 */           \
  F(float, k1)         /* distortion: radius r (tangent of the angle to the axis) is imaged at */   \
  F(float, k2)         /* ... r (1 + k1 r^2 + k2 r^4) */                                            \
  F(float, reach)      /* upper bound of r on the film; 0: no distortion */                         \
  F(float, split)      /* 1: each channel has its own rays; 0: all use the first below */           \
  F(vec3, image_scale) /* magnification of the image of each channel */                             \
  F(vec3, focus)       /* distance along z at which each channel is in focus */                     \
  F(float, panorama)   /* PANORAMA_*; the fields below are only used with FEATURE_PANORAMA, see */  \
                       /* panorama_camera.h. x and y are unit vectors */                            \
  F(float, center_x)   /* coordinates of the film's centre */                                       \
  F(float, center_y)                                                                                \
  F(float, half_x)   /* ... of its left edge, from there */                                         \
  F(float, half_y)   /* ... of its top edge */                                                      \
  F(float, limit)    /* radius of a fisheye's circle in its coordinates */                          \
  F(float, pictures) /* 1; 2: of the left and the right eye, one above the other */                 \
  F(float, eye)      /* half the distance of the eyes */

#define FILM_PARAMETERS_FIELDS(F)                     \
  F(int, width)                                       \
  F(int, height)                                      \
  F(int, filter)          /* FILTER_* */              \
  F(float, filter_radius) /* half-width, in pixels */ \
  F(float, sky_coverage)  /* alpha of rays that hit nothing: 1 if they see a sky, else 0 */

#define SAMPLER_PARAMETERS_FIELDS(F) \
  F(int, kind) /* SAMPLER_* */       \
  F(uint, spp)                       \
  F(uint, seed)

#define INTEGRATOR_PARAMETERS_FIELDS(F)                                                                \
  F(int, kind)      /* INTEGRATOR_* */                                                                 \
  F(int, max_depth) /* path: largest number of edges; INT_MAX for no limit */                          \
  F(int, rr_depth)                                                                                     \
  F(int, direct_sampling) /* SAMPLING_* */                                                             \
  F(int, only_bounces)    /* path: the only number of bounces whose light is kept; -1: all */          \
  F(int, only_technique)  /* path: TECHNIQUE_* */                                                      \
  F(int, emitter_samples)                                                                              \
  F(int, bsdf_samples)                                                                                 \
  F(int, bsdf_sampling)    /* DIRECTION_* */                                                           \
  F(int, heuristic)        /* HEURISTIC_* */                                                           \
  F(int, hide_emitters)    /* HIDE_* */                                                                \
  F(int, light_choice)     /* CHOICE_* */                                                              \
  F(int, trace_shadows)    /* 0: shadow rays are not traced */                                         \
  F(int, estimator)        /* ESTIMATOR_* */                                                           \
  F(int, branch_depth)     /* whitted: surfaces at which a path branches, at most MAX_BRANCH_DEPTH */  \
  F(int, leads_back)       /* whitted: 1 if a ray can always return to a surface to sample it again */ \
  F(int, weighting)        /* occlusion: WEIGHTING_* of directions */                                  \
  F(float, exponent)       /* occlusion: exponent of DIRECTION_LOBE */                                 \
  F(float, background)     /* occlusion: value of camera rays that hit nothing */                      \
  F(float, ray_length)     /* occlusion: only hits within it occlude; NO_LIMIT: all */                 \
  F(int, photons)          /* PHOTONS_*; the fields below are only used with FEATURE_PHOTONS */        \
  F(int, surface_photons)  /* paths of photons that are emitted for the map of surfaces */             \
  F(int, caustic_photons)  /* ... for caustics; PHOTONS_FIXED only */                                  \
  F(int, volume_photons)   /* ... for media */                                                         \
  F(float, surface_radius) /* of the first map; scene units */                                         \
  F(float, caustic_radius)                                                                             \
  F(float, volume_radius)                                                                              \
  F(float, radius_alpha)    /* PHOTONS_PROGRESSIVE: how fast radii shrink, 0 to 1; 1: not at all */    \
  F(int, samples_per_map)   /* PHOTONS_PROGRESSIVE: samples of a pixel that share a map */             \
  F(int, lookup_size)       /* PHOTONS_FIXED: the number of nearest photons that are looked up */      \
  F(int, gathering)         /* GATHER_* */                                                             \
  F(float, emission_radius) /* of a sphere about the origin that contains all shapes */

// Parameters that a viewer may change besides the camera: no table and no kernel depends on them.
#define ADJUSTABLE_FIELDS(F)             \
  F(float, alpha)  /* ESTIMATOR_ALPHA */ \
  F(float, frozen) /* FEATURE_MOTION: not 0: everything is as in the middle of the exposure */

// The list of the scene's tables: T(A, name, record, least, what), where A is passed on. It generates the
// header, the pointers, the checks, serialisation and `penumbra info`. Every table has at least `least`
// records, whatever its count: kernels read them for rays that miss and for idle lanes. `what` is its name
// for users.
#define SCENE_TABLES(T, A)                                                                 \
  T(A, triangles, Triangle, 1, "triangles")                                                \
  T(A, normals, VertexNormals, 1, "vertex normals")                                        \
  T(A, quadrics, Quadric, 1, "spheres, disks, cylinders, pieces of curves")                \
  T(A, materials, Material, 1, "materials")                                                \
  T(A, curves, float, 1, "curves of BSDFs")                                                \
  T(A, textures, TextureNode, 1, "textures")                                               \
  T(A, texels, uint, LEAST_TEXELS, "words of texels")                                      \
  T(A, lights, Light, 1, "lights")                                                         \
  T(A, light_cells, int, 1, "cells of the choice of lights")                               \
  T(A, polygons, Polygon, 1, "polygon lights")                                             \
  T(A, polygon_corners, PolygonCorner, 1, "corners of polygon lights")                     \
  /* FEATURE_UV: one for each triangle; one for each light. */                             \
  T(A, vertex_uvs, VertexUvs, 1, "texture coordinates of triangles")                       \
  T(A, light_triangles, LightTriangles, 1, "triangles of lights")                          \
  /* FEATURE_TANGENTS: one for each triangle. */                                           \
  T(A, vertex_tangents, VertexTangents, 1, "tangents of triangles")                        \
  /* FEATURE_LIGHT_TREE: nodes of the cut come first, see light_tree_builder.h. */         \
  T(A, light_nodes, LightNode, 2, "nodes of the hierarchy of lights")                      \
  T(A, light_trails, uint, 1, "ways to lights in their hierarchy")                         \
  T(A, light_members, LightMember, 1, "lights of leaves that have several")                \
  T(A, light_numbers, int, 1, "shares of lights in leaves")                                \
  /* mesh_attribute textures: for each triangle, the index of its colours, or -1. */       \
  T(A, triangle_colours, int, 1, "triangles that may have colours")                        \
  T(A, vertex_colours, VertexColours, 1, "colours of vertices")                            \
  /* FEATURE_LTC: the cells of GGX, then those of Beckmann. */                             \
  T(A, ltc_cells, LtcCell, 0, "linearly transformed cosines")                              \
  /* Small scenes: distinct vertices, and three indices for each triangle. */              \
  T(A, vertices, vec3, 0, "vertices, to test every primitive")                             \
  T(A, corners, Corner, 0, "corners, to test every primitive")                             \
  /* Large scenes: the BVH, see BVH_NODE_FIELDS. */                                        \
  T(A, nodes, BvhNode, 0, "nodes of the hierarchy")                                        \
  T(A, triangle_leaves, TriangleLeaf, 0, "leaves of triangles")                            \
  T(A, quadric_leaves, QuadricLeaf, 0, "leaves of spheres, disks and cylinders")           \
  /* FEATURE_INSTANCES. */                                                                 \
  T(A, groups, PrimitiveGroup, 1, "groups of shapes")                                      \
  T(A, instances, Instance, 1, "instances")                                                \
  /* FEATURE_MATTES: matte numbers of triangles, then of quadrics, from 1 on. */           \
  /* In a group they start at 0 and are added to the instance's first number. */           \
  T(A, mattes, int, 1, "mattes of primitives")                                             \
  T(A, instance_mattes, int, 1, "first mattes of instances")                               \
  /* FEATURE_SHAPE_LAYER: shape numbers of triangles, then of quadrics, from 1 on. */      \
  T(A, primitive_shapes, int, 1, "shapes of primitives")                                   \
  /* FEATURE_MEDIA: boundary index of each triangle, then of each quadric, or -1. */       \
  T(A, media, Medium, 1, "media")                                                          \
  T(A, phase_lobes, PhaseLobe, PHASE_LOBES, "phase functions")                             \
  T(A, boundaries, Boundary, 1, "boundaries of media")                                     \
  T(A, primitive_boundaries, int, 1, "primitives that bound media")                        \
  T(A, flight_centres, FlightCentre, 1, "places from where lights shine on media")         \
  T(A, light_media, LightMedia, 1, "media at lights")                                      \
  T(A, volumes, Volume, 1, "volumes")                                                      \
  T(A, volume_values, float, 3, "numbers of volumes")                                      \
  T(A, majorants, float, 1, "majorants of volumes")                                        \
  /* See filter.h. */                                                                      \
  T(A, filter_table, float, FILTER_TABLE_SIZE, "cells of the pixel filter")                \
  /* FEATURE_LIGHT_EDGES: index of the first record of each film row, and the end. */      \
  T(A, light_edge_rows, int, 2, "rows of edges of lights")                                 \
  T(A, light_edge_pixels, LightEdgePixel, 1, "pixels with edges of lights")                \
  T(A, light_edges, LightEdge, 1, "edges of lights in pixels")                             \
  /* FEATURE_MOTION: of the triangles, quadrics and instances that move; of all lights. */ \
  T(A, shutter, Shutter, 1, "shutters")                                                    \
  T(A, shutter_curve, float, 4, "values of the shutter's curve, and its integral")         \
  T(A, camera_states, Camera, 1, "states of the camera")                                   \
  T(A, triangle_motions, Motion, 1, "triangles that move")                                 \
  T(A, triangle_states, TriangleState, 1, "states of triangles")                           \
  T(A, quadric_motions, Motion, 1, "spheres, disks and cylinders that move")               \
  T(A, quadric_states, Quadric, 1, "states of spheres, disks and cylinders")               \
  T(A, instance_motions, Motion, 1, "instances that move")                                 \
  T(A, instance_states, InstanceState, 1, "states of instances")                           \
  T(A, light_motions, Motion, 1, "lights that may move")                                   \
  T(A, light_states, LightState, 1, "states of lights")                                    \
  T(A, motion_nodes, MotionNode, 1, "nodes of the hierarchy of what moves")                \
  T(A, motion_leaves, MotionLeaf, 1, "leaves of what moves")                               \
  LIGHT_TABLES(T, A)

// The index fields: I(table, record, member, target table, least, error message). The message is reported if
// the member is below `least` or not an index of the target table. In empty tables, the records that kernels
// read anyway are checked too.
#define MATERIAL_TEXTURE_INDEX(I, type, name) \
  I(materials, Material, name##_texture, textures, -1, "a material names a texture that is not there")
#define SCENE_INDICES(I)                                                                                  \
  I(triangles, Triangle, front, materials, 0, "a triangle names a material that is not there")            \
  I(triangles, Triangle, back, materials, 0, "a triangle names a material that is not there")             \
  I(triangles, Triangle, light, lights, -1, "a triangle names a light that is not there")                 \
  I(triangles, Triangle, normals, normals, -1, "a triangle names normals that are not there")             \
  I(quadrics, Quadric, front, materials, 0, "a quadric names a material that is not there")               \
  I(quadrics, Quadric, back, materials, 0, "a quadric names a material that is not there")                \
  I(quadrics, Quadric, light, lights, -1, "a quadric names a light that is not there")                    \
  MATERIAL_TEXTURES(MATERIAL_TEXTURE_INDEX, I)                                                            \
  I(materials, Material, first, materials, -1, "a material names another one that is not there")          \
  I(materials, Material, second, materials, -1, "a material names another one that is not there")         \
  I(media, Medium, material, materials, 0, "a medium names a material that is not there")                 \
  I(media, Medium, density, volumes, -1, "a medium names a volume that is not there")                     \
  I(media, Medium, albedo_grid, volumes, -1, "a medium names a volume that is not there")                 \
  I(media, Medium, emission_grid, volumes, -1, "a medium names a volume that is not there")               \
  I(media, Medium, light, lights, -1, "a medium names a light that is not there")                         \
  I(glows, Glow, medium, media, 0, "a light names a medium that is not there")                            \
  I(glows, Glow, volume, volumes, 0, "a light names a volume that is not there")                          \
  I(boundaries, Boundary, interior, media, 0, "a boundary names a medium that is not there")              \
  I(boundaries, Boundary, exterior, media, -1, "a boundary names a medium that is not there")             \
  I(textures, TextureNode, texture0, textures, -1, "a texture names another one that is not there")       \
  I(textures, TextureNode, texture1, textures, -1, "a texture names another one that is not there")       \
  I(lights, Light, texture, textures, -1, "a light names a texture that is not there")                    \
  I(light_triangles, LightTriangles, first, triangles, -1, "a light names a triangle that is not there")  \
  I(light_triangles, LightTriangles, second, triangles, -1, "a light names a triangle that is not there") \
  I(light_triangles, LightTriangles, quadric, quadrics, -1, "a light names a quadric that is not there")  \
  I(instances, Instance, group, groups, 0, "an instance names a group that is not there")                 \
  I(corners, Corner, v0, vertices, 0, "a corner names a vertex that is not there")                        \
  I(corners, Corner, v1, vertices, 0, "a corner names a vertex that is not there")                        \
  I(corners, Corner, v2, vertices, 0, "a corner names a vertex that is not there")

// The position of a table: the offset counts 32-bit words from the start of the scene's array. The count is 0
// for a table that the scene does not need.
#define TABLE_SPAN_FIELDS(F) \
  F(int, count)              \
  F(uint, offset)

#define TABLE_SPAN_FIELD(F, name, record, least, what) F(TableSpan, name)
#define TABLE_SPANS_FIELDS(F) SCENE_TABLES(TABLE_SPAN_FIELD, F)

// All scene data that is not in a table.
#define SCENE_HEADER_FIELDS(F)                                                                      \
  F(ulong, features)     /* FEATURE_* bits */                                                       \
  F(ulong, families)     /* bits 1 << FAMILY_* of its materials */                                  \
  F(ulong, textured)     /* bits 1 << TEXTURED_* of the fields that are textured in a material */   \
  F(uint, texture_kinds) /* bits 1 << TEXTURE_* of its textures */                                  \
  F(int, intersector)    /* INTERSECTOR_* */                                                        \
  F(Camera, camera)                                                                                 \
  F(FilmParameters, film)                                                                           \
  F(SamplerParameters, sampler)                                                                     \
  F(IntegratorParameters, integrator)                                                               \
  F(Adjustable, adjustable)                                                                         \
  F(int, environment)       /* index of the environment light, or -1 */                             \
  F(int, first_sun)         /* suns are among the lights from this one on: ... */                   \
  F(int, sun_count)         /* ... as many lights; 0: there are no suns */                          \
  F(uint, light_kinds)      /* bits 1 << LIGHT_* of its lights */                                   \
  F(int, light_cut)         /* number of light hierarchy nodes without a parent */                  \
  F(int, light_tree_depth)  /* steps from there to the deepest leaf */                              \
  F(int, light_leaf_steps)  /* steps to find a light in a leaf; 0: one light per leaf */            \
  F(int, matte_count)       /* FEATURE_MATTES: the largest matte number */                          \
  F(int, shape_count)       /* FEATURE_SHAPE_LAYER: the largest number of a shape */                \
  F(vec3, center)           /* FEATURE_POSITION_LAYER: the scene's centre in the world */           \
  F(int, camera_medium)     /* index of the medium that the camera is in */                         \
  F(int, dropped_triangles) /* degenerate in single precision: left out, and reported */            \
  F(uint, own_camera)       /* FEATURE_LIGHT_EDGES, FEATURE_MOTION: camera_key of its own camera */ \
  F(int, sees_edges)        /* 1 if the current camera is that one; else the edges are ignored, */  \
  F(int, camera_moves)      /* ... and the camera's states; 0 if it has none */                     \
  F(int, duplicate_lights)  /* light triangles that repeat another one: they do not emit again */   \
  F(TableSpans, tables)

// X(struct, field list) for all shared structs: for tests and for serialisation.
#define SHARED_STRUCTS(X)                               \
  X(Triangle, TRIANGLE_FIELDS)                          \
  X(VertexNormals, VERTEX_NORMALS_FIELDS)               \
  X(VertexUvs, VERTEX_UVS_FIELDS)                       \
  X(VertexTangents, VERTEX_TANGENTS_FIELDS)             \
  X(VertexColours, VERTEX_COLOURS_FIELDS)               \
  X(Quadric, QUADRIC_FIELDS)                            \
  X(Instance, INSTANCE_FIELDS)                          \
  X(PrimitiveGroup, PRIMITIVE_GROUP_FIELDS)             \
  X(Motion, MOTION_FIELDS)                              \
  X(TriangleState, TRIANGLE_STATE_FIELDS)               \
  X(InstanceState, INSTANCE_STATE_FIELDS)               \
  X(LightState, LIGHT_STATE_FIELDS)                     \
  X(Shutter, SHUTTER_FIELDS)                            \
  X(MotionNode, MOTION_NODE_FIELDS)                     \
  X(MotionLeaf, MOTION_LEAF_FIELDS)                     \
  X(Material, MATERIAL_FIELDS)                          \
  X(TextureNode, TEXTURE_FIELDS)                        \
  X(Medium, MEDIUM_FIELDS)                              \
  X(Volume, VOLUME_FIELDS)                              \
  X(PhaseLobe, PHASE_LOBE_FIELDS)                       \
  X(FlightCentre, FLIGHT_CENTRE_FIELDS)                 \
  X(Boundary, BOUNDARY_FIELDS)                          \
  X(Light, LIGHT_FIELDS)                                \
  X(LightTriangles, LIGHT_TRIANGLES_FIELDS)             \
  X(LightNode, LIGHT_NODE_FIELDS)                       \
  X(LightMember, LIGHT_MEMBER_FIELDS)                   \
  X(EnvironmentMap, ENVIRONMENT_MAP_FIELDS)             \
  X(Beam, BEAM_FIELDS)                                  \
  X(Glow, GLOW_FIELDS)                                  \
  X(GlowBlock, GLOW_BLOCK_FIELDS)                       \
  X(Polygon, POLYGON_FIELDS)                            \
  X(PolygonCorner, POLYGON_CORNER_FIELDS)               \
  X(LightEdgePixel, LIGHT_EDGE_PIXEL_FIELDS)            \
  X(LightEdge, LIGHT_EDGE_FIELDS)                       \
  X(LightMedia, LIGHT_MEDIA_FIELDS)                     \
  X(BvhNode, BVH_NODE_FIELDS)                           \
  X(TriangleLeaf, TRIANGLE_LEAF_FIELDS)                 \
  X(QuadricLeaf, QUADRIC_LEAF_FIELDS)                   \
  X(Corner, CORNER_FIELDS)                              \
  X(LtcCell, LTC_CELL_FIELDS)                           \
  X(Photon, PHOTON_FIELDS)                              \
  X(PhotonMap, PHOTON_MAP_FIELDS)                       \
  X(Camera, CAMERA_FIELDS)                              \
  X(FilmParameters, FILM_PARAMETERS_FIELDS)             \
  X(SamplerParameters, SAMPLER_PARAMETERS_FIELDS)       \
  X(IntegratorParameters, INTEGRATOR_PARAMETERS_FIELDS) \
  X(Adjustable, ADJUSTABLE_FIELDS)                      \
  X(TableSpan, TABLE_SPAN_FIELDS)                       \
  X(TableSpans, TABLE_SPANS_FIELDS)                     \
  X(SceneHeader, SCENE_HEADER_FIELDS)

#define DECLARE_FIELD(type, name) type name;
#define DECLARE_STRUCT(name, fields) \
  typedef struct {                   \
    fields(DECLARE_FIELD)            \
  } name;
SHARED_STRUCTS(DECLARE_STRUCT)
#undef DECLARE_STRUCT
#undef DECLARE_FIELD

/// Of a quadric.
FN bool is_curve_kind(int kind) { return kind >= QUADRIC_ROUND; }

PENUMBRA_NAMESPACE_END
#endif
