// Every struct that host and device share, from one field list each: scalars and packed vec3 only, so that
// all compilers lay them out alike (a test compares the offsets that an OpenCL device reports with the
// host's).
#ifndef PENUMBRA_SCENE_TYPES_H
#define PENUMBRA_SCENE_TYPES_H
#include "kernels/bsdf/families.h"
#include "kernels/features.h"
#include "kernels/light/light_kinds.h"
#include "kernels/math/vec3.h"
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

// What of the light of paths is kept: what samples of directions found, or samples of emitters.
#define TECHNIQUE_ALL 0
#define TECHNIQUE_BSDF 1
#define TECHNIQUE_EMITTER 2

#define CHOICE_POWER 0
#define CHOICE_ANALYTIC 1
#define CHOICE_TREE 2

// How the samples H of the polygon lights, W without shadows, and their closed form G make an estimate.
#define ESTIMATOR_SAMPLES 0  // H alone
#define ESTIMATOR_ALPHA 1    // alpha G + (H - alpha W)
#define ESTIMATOR_AUTO 2     // the same, alpha from other samples of the pixel

// What the camera sees of emitters: their light, a surface without it, or what is behind them.
#define HIDE_NOTHING 0
#define HIDE_LIGHT 1
#define HIDE_LOOK_THROUGH 2

#define HEURISTIC_BALANCE 0
#define HEURISTIC_POWER 1

#define DIRECTION_BSDF 0
#define DIRECTION_COSINE 1
#define DIRECTION_UNIFORM 2
#define DIRECTION_SPHERE 3  // occlusion alone, and ...
#define DIRECTION_LOBE 4    // ... about the mirror direction

#define WEIGHTING_COSINE 0
#define WEIGHTING_UNIFORM 1
#define WEIGHTING_NORMALS 2 /* directions play no part: the normal itself is what is seen */

#define EMITTER_AREA 0
#define EMITTER_SOLID_ANGLE 1
#define EMITTER_PROJECTED 2

#define QUADRIC_SPHERE 0
#define QUADRIC_DISK 1
#define QUADRIC_CYLINDER 2

// How many rays pass through a material: none, all, or as its leaves are chosen.
#define PASSES_NONE 0
#define PASSES_ALL 1
#define PASSES_SOME 2

#define MAX_MEDIA 255             // with nothing, which is one
#define MAX_VOLUME_CELLS 1048576  // along an axis: floats hold places among them

#define PHASE_HG 0  // isotropic where g is 0
#define PHASE_RAYLEIGH 1
#define PHASE_LOBES 4  // of every mixture of phase functions; those that it lacks have weight 0

#define BEND_NOT 0
#define BEND_NORMAL_MAP 1
#define BEND_BUMP_MAP 2

#define NO_MATTE 0           // of a ray that hits nothing
#define MAX_MATTES 16777215  // numbers that a float holds exactly

#define BVH_WIDTH 8               // children of a node, primitives of a leaf
#define MAX_DIRECT_SAMPLES 65536  // emitter or BSDF samples of one camera ray
#define LIGHT_NUMBERS \
  16777216.0f               // 2^24: probabilities within the hierarchy of lights are multiples of its inverse
#define LIGHT_CUT 16        // nodes at most from which a walk through the hierarchy of lights begins
#define MAX_BRANCH_DEPTH 8  // surfaces at which a path may branch, one after the other
#define FILTER_CELLS 256
#define LTC_SIZE 32  // rows and columns of a table of linearly transformed cosines
#define FILTER_TABLE_SIZE (2 * FILTER_CELLS + 1)  // knots and weights, see filter.h

// The scene's centre is the origin: the builder subtracts it in double before anything becomes float.
#define TRIANGLE_FIELDS(F)                                                    \
  F(vec3, p0)                                                                 \
  F(vec3, p1)                                                                 \
  F(vec3, p2)     /* the front side sees them counter-clockwise */            \
  F(int, front)   /* material of the side that (p1 - p0) x (p2 - p0) faces */ \
  F(int, back)    /* material of the other side */                            \
  F(int, light)   /* index of the light it is, or -1; emits from the front */ \
  F(int, normals) /* index into the vertex normals, or -1: faceted */

#define VERTEX_NORMALS_FIELDS(F) \
  F(vec3, n0)                    \
  F(vec3, n1)                    \
  F(vec3, n2)

// Texture coordinates of a triangle's vertices; barycentric ones where a mesh has none.
#define VERTEX_UVS_FIELDS(F) \
  F(float, u0)               \
  F(float, v0)               \
  F(float, u1)               \
  F(float, v1)               \
  F(float, u2)               \
  F(float, v2)

#define QUADRIC_FIELDS(F)                                                                                    \
  F(vec3, center) /* cylinder: of its first end */                                                           \
  F(vec3, normal) /* unit; disk: the front side, sphere: the pole of its texture coordinates, cylinder: its  \
                     axis */                                                                                 \
  F(float, radius)                                                                                           \
  F(float, length)      /* of a cylinder, else 1 */                                                          \
  F(vec3, x_axis)       /* unit, at right angles to the normal and each other, mirrored or not: the frame */ \
  F(vec3, y_axis)       /* ... of texture coordinates */                                                     \
  F(float, orientation) /* sphere, cylinder: 1 if outside is the front, else -1 */                           \
  F(int, kind)          /* QUADRIC_* */                                                                      \
  F(int, front)                                                                                              \
  F(int, back)                                                                                               \
  F(int, light)

// A group of shapes in its place. The group's triangles and quadrics are relative to its own centre; a point
// p of it lies at x p.x + y p.y + z p.z + at in the scene. Rows are those of the inverse matrix.
#define INSTANCE_FIELDS(F) \
  F(vec3, x)               \
  F(vec3, y)               \
  F(vec3, z)               \
  F(vec3, at)              \
  F(vec3, row_x)           \
  F(vec3, row_y)           \
  F(vec3, row_z)           \
  F(int, group)

// Consecutive primitives. Group 0 of a scene with instances is what is in it once, the others are what
// instances place.
#define PRIMITIVE_GROUP_FIELDS(F)                         \
  F(int, root) /* of its part of the hierarchy: a node */ \
  F(int, first_triangle)                                  \
  F(int, triangle_count)                                  \
  F(int, first_quadric)                                   \
  F(int, quadric_count)

// What its closures have; material 0 absorbs everything.
#define MATERIAL_FIELD(F, type, name) F(type, name)
#define MATERIAL_TEXTURE(F, type, name) F(int, name##_texture) /* index, or -1: its value alone */
// Whatever of a material may have a texture: its closure's fields, and two of its own.
#define MATERIAL_TEXTURES(F, a) \
  TEXTURED_FIELDS(F, a)         \
  F(a, float, weight)           \
  F(a, int, bend)
// A material is a leaf, which scatters by its closure, or one of two others, each point of a surface by
// chance: `first` and `second` have lower indices than it, or are -1, nothing, through which rays pass. A
// leaf's shading normal may be bent by a texture.
#define MATERIAL_TREE_FIELDS(F)                                                                 \
  F(int, passes)       /* PASSES_* */                                                           \
  F(int, first)        /* index, or -1 */                                                       \
  F(int, second)       /* likewise; in a leaf it is -1, and `branches` 0 */                     \
  F(int, branches)     /* 1: it is one of those two */                                          \
  F(float, weight)     /* probability of the second; a texture's value is clamped to [0, 1] */  \
  F(int, bend)         /* BEND_*: what bends the normal of a leaf */                            \
  F(float, bend_scale) /* how much, see bend_normal.h; negative: the bumps of the other side */ \
  F(float, bend_step)  /* between texture coordinates whose heights are compared */             \
  F(int, bend_shadows) /* 1: its bumps shade each other, see bump_shadow */                     \
  F(float, pane)       /* of a leaf: the relative index of a thin pane, which rays pass by chance, or 0 */

#define MATERIAL_FIELDS(F)               \
  CLOSURE_FIELDS(MATERIAL_FIELD, F)      \
  MATERIAL_TEXTURES(MATERIAL_TEXTURE, F) \
  MATERIAL_TREE_FIELDS(F)

// What fills space. Record 0 is nothing: its extinction is 0. See medium/flight.h.
#define MEDIUM_FIELDS(F)                                                                                     \
  F(vec3, extinction) /* in 1 / scene unit */                                                                \
  F(vec3, albedo)     /* the scattered share of it */                                                        \
  F(int, material)    /* of FAMILY_PHASE: how it scatters */                                                 \
  F(int, density) /* a volume by which the extinction is multiplied, outside of whose box there is none; -1: \
                     none */                                                                                 \
  F(int, albedo_grid) /* a volume by which the albedo is multiplied, or -1 */

// Numbers on a grid in space: see medium/volume.h.
#define VOLUME_FIELDS(F)                                                                \
  F(vec3, corner) /* where cell 0, 0, 0 begins */                                       \
  F(vec3, row_x)  /* from the way from there to the place in cells */                   \
  F(vec3, row_y)                                                                        \
  F(vec3, row_z)                                                                        \
  F(int, nx)                                                                            \
  F(int, ny)                                                                            \
  F(int, nz)                                                                            \
  F(int, channels)       /* 1 or 3 */                                                   \
  F(int, nearest)        /* 1: a cell has one value; 0: interpolated between centres */ \
  F(int, first_value)    /* in volume_values, x fastest, of each cell all channels */   \
  F(int, first_majorant) /* in majorants, x fastest: the largest value in MAJORANT_CELLS^3 cells */

// One of the PHASE_LOBES that a medium's phase function is a mixture of.
#define PHASE_LOBE_FIELDS(F)                                                \
  F(int, kind)     /* PHASE_* */                                            \
  F(float, g)      /* mean cosine of Henyey and Greenstein's, of (-1, 1) */ \
  F(float, weight) /* of the mixture, whose weights add up to 1 */

// From where lights shine on media: see medium/equiangular.h.
#define FLIGHT_CENTRE_FIELDS(F)                                     \
  F(vec3, place)                                                    \
  F(float, size)  /* of the lights there, as far as they are one */ \
  F(float, below) /* it is chosen by numbers below that, and of those before it above theirs */

// Of a shape's surface, which parts two media.
#define BOUNDARY_FIELDS(F)                                          \
  F(int, interior) /* a medium: behind the front side */            \
  F(int, exterior) /* likewise before it; -1: whatever is around */ \
  F(int, shape)    /* the index of the shape in the scene, for messages */

#define LIGHT_FIELDS(F)                                                                                   \
  F(vec3,                                                                                                 \
    radiance) /* radiance; radiant intensity of a point or spot light, irradiance of a directional one */ \
  F(vec3, p0) /* triangle vertex, rectangle corner; centre (of a cylinder's first end), or position */    \
  F(vec3, p1) /* triangle vertex, next corner; disk: unit normal of the front; cylinder: unit axis;       \
                 unit direction of a directional light */                                                 \
  F(vec3, p2) /* triangle vertex, previous corner; others: (radius, orientation, length) */               \
  F(float, area)                                                                                          \
  F(int, sampling)  /* EMITTER_* */                                                                       \
  F(int, two_sided) /* 1: emits from the back as well */                                                  \
  F(int, polygon)   /* index of the polygon light that it is a part of, or -1 */                          \
  F(float, pmf)     /* probability of choosing this light */                                              \
  F(int, start)     /* of the LIGHT_NUMBERS, which choose by power, the first that is its own */          \
  F(int, kind)      /* LIGHT_* */                                                                         \
  F(int, texture)   /* by whose values its radiance is multiplied, an index, or -1 */                     \
  F(int, grid)      /* where its distribution begins in the light grids, or -1: it has none */            \
  F(int, grid_side)                                                                                       \
  F(int, beam) /* of a spot light or a projector, an index */

// A node of the hierarchy of lights, see light_tree.h: bounds of its lights, which shine within an angle of
// cosine cos_e about axes within cos_o of its own, weaker by the cosine of the angle between. An infinite
// one has no place; its axes are where its light travels, its intensity irradiance.
#define LIGHT_NODE_FIELDS(F)                                                                               \
  F(vec3, center)                                                                                          \
  F(vec3, half_size) /* of the box about the centre */                                                     \
  F(vec3, axis)      /* unit */                                                                            \
  F(float, radius)   /* of the ball about the box */                                                       \
  F(float, inverse_radius)                                                                                 \
  F(float, cos_o)                                                                                          \
  F(float, sin_o)                                                                                          \
  F(float, cos_e)                                                                                          \
  F(float, intensity)      /* along an axis, all together; in units of the hierarchy */                    \
  F(int, flags)            /* LIGHTS_* */                                                                  \
  F(int, child)            /* index of the first of two neighbours, or ~light, or ~first of its members */ \
  F(int, lights)           /* of a leaf, which has members if there are several; 0: it has children */
#define LIGHTS_TWO_SIDED 1 /* along the other direction of an axis as well */
#define LIGHTS_INFINITE 2  /* all of them */

// One of the lights of a leaf that has several.
#define LIGHT_MEMBER_FIELDS(F) \
  F(int, light)                \
  F(int, start) /* how many of the LIGHT_NUMBERS take those before it in the leaf */

// An image of radiance from all directions, see envmap_light.h.
#define ENVIRONMENT_MAP_FIELDS(F) \
  F(int, width)                   \
  F(int, height)

// The directions into which a spot light or a projector shines, see beam.h.
#define BEAM_FIELDS(F)                                                                           \
  F(vec3, x) /* unit, of the light's own frame, mirrored or not */                               \
  F(vec3, y)                                                                                     \
  F(vec3, z)       /* the middle of the beam */                                                  \
  F(float, u_by_x) /* texture coordinates: 1/2 + u_by_x x / z and 1/2 + v_by_y y / z */          \
  F(float, v_by_y)                                                                               \
  F(int, falloff)         /* SPOT_* */                                                           \
  F(float, beam_width)    /* spot: within it all light; an angle if linear, or 1 - its cosine */ \
  F(float, cutoff)        /* ... beyond it none; likewise */                                     \
  F(float, inverse_width) /* 1 / (cutoff - beam_width), or 0 if both are the same */

// How a spot light falls off from its beam to its cutoff: linearly in the angle (Mitsuba), as 3t^2 - 2t^3 of
// the cosine (pbrt), as its square (glTF).
#define SPOT_LINEAR 0
#define SPOT_SMOOTHSTEP 1
#define SPOT_SQUARED 2

// What a light is: one triangle, or a rectangle's two, or a quadric; -1: none.
#define LIGHT_TRIANGLES_FIELDS(F)                \
  F(int, first)                                  \
  F(int, second)  /* the same if there is one */ \
  F(int, quadric) /* the sphere or disk that it is, or -1 */

// What a mesh_attribute texture shows.
#define VERTEX_COLOURS_FIELDS(F) \
  F(vec3, c0)                    \
  F(vec3, c1)                    \
  F(vec3, c2)

// A planar light: coplanar triangles (or one rectangle) of equal emission that face the same side, merged
// into their outline, so that its closed form costs what the outline does.
#define POLYGON_FIELDS(F)                                                                    \
  F(vec3, radiance)                                                                          \
  F(int, two_sided) /* 1: emits from the back as well */                                     \
  F(float, area)                                                                             \
  F(float, size)       /* largest distance between two of its vertices, or an upper bound */ \
  F(int, first_corner) /* its outline in the table of polygon corners */                     \
  F(int, corner_count)                                                                       \
  F(int, first_light) /* its parts, consecutive lights */                                    \
  F(int, light_count)

// A corner of an outline. Each closed loop repeats its first corner at its end; seen from the front,
// the inside is to the left of every edge (outer loops counter-clockwise, holes clockwise).
#define POLYGON_CORNER_FIELDS(F) \
  F(vec3, p)                     \
  F(int, starts) /* 1: a loop starts here, so no edge leads from the corner before */

// What a camera sees of the edges of a light of constant radiance: see camera/light_edges.h. One for each of
// their pixels and radiances, in the order of x within a row.
#define LIGHT_EDGE_PIXEL_FIELDS(F)                                                           \
  F(vec3, radiance) /* by which the light is brighter than what is beside it, where seen */  \
  F(float, share)   /* of the pixel, by its filter, that the light takes up; unobstructed */ \
  F(int, x)                                                                                  \
  F(int, first_edge)                                                                         \
  F(int, edge_count)

// A piece of an edge within the reach of a pixel's filter, about the pixel's centre and in filter radii: at y
// of [y0, y1), or [y1, y0), it is at x0 + slope (y - y0). The light is at smaller x where y1 > y0, else at
// larger x.
#define LIGHT_EDGE_FIELDS(F) \
  F(float, x0)               \
  F(float, y0)               \
  F(float, y1)               \
  F(float, slope)

// Inner node of the wide BVH: child k is a node if child[k] >= 0, else leaf ~child[k]. An empty slot is any
// leaf in an inverted box. Leaves below `triangle_leaves.count` hold triangles, the next
// `quadric_leaves.count` quadrics; those that follow are instances, which only what is below node 0 has.
#define BVH_NODE_FIELDS(F)                                          \
  F(float, bounds[6][BVH_WIDTH]) /* least x, y, z, then greatest */ \
  F(int, child[BVH_WIDTH])

// A leaf's triangles, vertex v's coordinate axis as p[v][axis]; unused slots have primitive -1.
#define TRIANGLE_LEAF_FIELDS(F) \
  F(float, p[3][3][BVH_WIDTH])  \
  F(int, primitive[BVH_WIDTH])

#define QUADRIC_LEAF_FIELDS(F) F(int, primitive[BVH_WIDTH])

// A linearly transformed cosine (Heitz et al. 2016) for a microfacet reflection of roughness alpha under
// cosine c and sine s of the viewer. It leans from the mirror direction to the normal by an angle of sine
// s * lean; with q the tangent of what is left of the viewer's angle its half-widths in the plane z = 1,
// where it is centred at (q, 0), are 2 alpha (1 + q^2) width_x and 2 alpha width_y. Row i is that of
// roughness (i / (LTC_SIZE - 1))^2, column j that of c = (j / (LTC_SIZE - 1))^2.
#define LTC_CELL_FIELDS(F)                                                       \
  F(float, lean)                                                                 \
  F(float, width_x)                                                              \
  F(float, width_y)                                                              \
  F(float, albedo)  /* what the reflection gives off without its Fresnel term */ \
  F(float, schlick) /* mean of (1 - cos)^5 over it, of the angle at the microfacets */

#define CORNER_FIELDS(F) \
  F(int, v0)             \
  F(int, v1)             \
  F(int, v2)

// What a ray through the film starts from; lengths in the scene's units. From `parallel` on only cameras of
// FEATURE_CAMERA have a use for them, see lens_camera.h.
#define CAMERA_FIELDS(F)                                                                               \
  F(vec3, origin)                                                                                      \
  F(vec3, x) /* to the left edge of the film, at distance 1 */                                         \
  F(vec3, y) /* to the top edge */                                                                     \
  F(vec3, z) /* unit viewing direction */                                                              \
  F(float, near_clip)                                                                                  \
  F(float, far_clip)                                                                                   \
  F(float, parallel) /* 1: rays through the lens' centre are parallel to z, x and y half the film's */ \
                     /* size; 0: they meet at the origin */                                            \
  F(float, offset_x) /* of the axis from the film's centre, to the left in half widths */              \
  F(float, offset_y) /* ... upwards in half heights */                                                 \
  F(float, lens_radius)                                                                                \
  F(float, blades)     /* corners of the lens; 0: a disk */                                            \
  F(float, blade_turn) /* from x towards y to the first corner, in turns, 0 to 1 */                    \
  F(float, k1)         /* r (1 + k1 r^2 + k2 r^4) is where what belongs to r is on the film, by the */ \
  F(float, k2)         /* ... tangents of the angles off the axis */                                   \
  F(float, reach)      /* the greatest r that is on the film, at most; 0: there is no distortion */    \
  F(float, split)      /* 1: channels have rays of their own, 0: all are as the first is below */      \
  F(vec3, image_scale) /* by how much the image of each channel is larger */                           \
  F(vec3, focus)       /* distance along z at which each is sharp */

#define FILM_PARAMETERS_FIELDS(F)                    \
  F(int, width)                                      \
  F(int, height)                                     \
  F(int, filter)          /* FILTER_* */             \
  F(float, filter_radius) /* half-width in pixels */ \
  F(float, sky_coverage)  /* alpha of what meets nothing: 1 where a sky is seen there, else 0 */

#define SAMPLER_PARAMETERS_FIELDS(F) \
  F(int, kind) /* SAMPLER_* */       \
  F(uint, spp)                       \
  F(uint, seed)

#define INTEGRATOR_PARAMETERS_FIELDS(F)                                                            \
  F(int, kind)      /* INTEGRATOR_* */                                                             \
  F(int, max_depth) /* path: edges; INT_MAX for no limit */                                        \
  F(int, rr_depth)                                                                                 \
  F(int, direct_sampling) /* SAMPLING_* */                                                         \
  F(int, only_bounces)    /* path: of light that is kept; -1 for all */                            \
  F(int, only_technique)  /* path: TECHNIQUE_* */                                                  \
  F(int, emitter_samples)                                                                          \
  F(int, bsdf_samples)                                                                             \
  F(int, bsdf_sampling) /* DIRECTION_* */                                                          \
  F(int, heuristic)     /* HEURISTIC_* */                                                          \
  F(int, hide_emitters) /* HIDE_* */                                                               \
  F(int, light_choice)  /* CHOICE_* */                                                             \
  F(int, trace_shadows) /* 0: nothing blocks shadow rays */                                        \
  F(int, estimator)     /* ESTIMATOR_* */                                                          \
  F(int, branch_depth)  /* whitted: surfaces at which a path branches, at most MAX_BRANCH_DEPTH */ \
  F(int, leads_back)    /* whitted: 1 if rays always find back to a surface, to sample it again */ \
  F(int, weighting)     /* occlusion: WEIGHTING_* of directions */                                 \
  F(float, exponent)    /* occlusion: of DIRECTION_LOBE */                                         \
  F(float, background)  /* occlusion: what camera rays see that meet nothing */                    \
  F(float, ray_length)  /* occlusion: what is farther away blocks nothing; NO_LIMIT for none */

// What a viewer may change besides the camera: no table and no kernel depends on it.
#define ADJUSTABLE_FIELDS(F) F(float, alpha) /* ESTIMATOR_ALPHA */

// The scene's tables, one a row, from which header, pointers, checks, storing and `penumbra info` follow:
// T(A, name, record, least, what), A whatever is passed on. Kernels read `least` records for rays that miss
// or lanes that idle, whatever the table's count: they are there. `what` is its name for people.
#define SCENE_TABLES(T, A)                                                             \
  T(A, triangles, Triangle, 1, "triangles")                                            \
  T(A, normals, VertexNormals, 1, "vertex normals")                                    \
  T(A, quadrics, Quadric, 1, "spheres, disks and cylinders")                           \
  T(A, materials, Material, 1, "materials")                                            \
  T(A, curves, float, 1, "curves of BSDFs")                                            \
  T(A, textures, TextureNode, 1, "textures")                                           \
  T(A, texels, uint, LEAST_TEXELS, "words of texels")                                  \
  T(A, lights, Light, 1, "lights")                                                     \
  T(A, light_cells, int, 1, "cells of the choice of lights")                           \
  T(A, polygons, Polygon, 1, "polygon lights")                                         \
  T(A, polygon_corners, PolygonCorner, 1, "corners of polygon lights")                 \
  /* FEATURE_UV: one for each triangle, one for each light. */                         \
  T(A, vertex_uvs, VertexUvs, 1, "texture coordinates of triangles")                   \
  T(A, light_triangles, LightTriangles, 1, "triangles of lights")                      \
  /* FEATURE_LIGHT_TREE: those of the cut first; see light_tree_builder.h. */          \
  T(A, light_nodes, LightNode, 2, "nodes of the hierarchy of lights")                  \
  T(A, light_trails, uint, 1, "ways to lights in their hierarchy")                     \
  T(A, light_members, LightMember, 1, "lights of leaves that have several")            \
  T(A, light_numbers, int, 1, "shares of lights in leaves")                            \
  /* Textures of mesh attributes: of each triangle the first of its colours, or -1. */ \
  T(A, triangle_colours, int, 1, "triangles that may have colours")                    \
  T(A, vertex_colours, VertexColours, 1, "colours of vertices")                        \
  /* FEATURE_LTC: that of GGX, then that of Beckmann's distribution. */                \
  T(A, ltc_cells, LtcCell, 0, "linearly transformed cosines")                          \
  /* Small scenes: distinct vertices, and three of them for each triangle. */          \
  T(A, vertices, vec3, 0, "vertices, to test every primitive")                         \
  T(A, corners, Corner, 0, "corners, to test every primitive")                         \
  /* Large scenes: see BVH_NODE_FIELDS. */                                             \
  T(A, nodes, BvhNode, 0, "nodes of the hierarchy")                                    \
  T(A, triangle_leaves, TriangleLeaf, 0, "leaves of triangles")                        \
  T(A, quadric_leaves, QuadricLeaf, 0, "leaves of spheres, disks and cylinders")       \
  /* FEATURE_INSTANCES. */                                                             \
  T(A, groups, PrimitiveGroup, 1, "groups of shapes")                                  \
  T(A, instances, Instance, 1, "instances")                                            \
  /* FEATURE_MATTES: the matte of each triangle and then of each quadric, from 1 on */ \
  /* on; of a group's, to be added to the first number of the instance, from 0 on. */  \
  T(A, mattes, int, 1, "mattes of primitives")                                         \
  T(A, instance_mattes, int, 1, "first mattes of instances")                           \
  /* FEATURE_MEDIA: of each triangle and then each quadric its boundary, or -1. */     \
  T(A, media, Medium, 1, "media")                                                      \
  T(A, phase_lobes, PhaseLobe, PHASE_LOBES, "phase functions")                         \
  T(A, boundaries, Boundary, 1, "boundaries of media")                                 \
  T(A, primitive_boundaries, int, 1, "primitives that bound media")                    \
  T(A, flight_centres, FlightCentre, 1, "places from where lights shine on media")     \
  T(A, volumes, Volume, 1, "volumes")                                                  \
  T(A, volume_values, float, 3, "numbers of volumes")                                  \
  T(A, majorants, float, 1, "majorants of volumes")                                    \
  /* See filter.h. */                                                                  \
  T(A, filter_table, float, FILTER_TABLE_SIZE, "cells of the pixel filter")            \
  /* FEATURE_LIGHT_EDGES: of each row of the film the first pixel, and their end. */   \
  T(A, light_edge_rows, int, 2, "rows of edges of lights")                             \
  T(A, light_edge_pixels, LightEdgePixel, 1, "pixels with edges of lights")            \
  T(A, light_edges, LightEdge, 1, "edges of lights in pixels")                         \
  LIGHT_TABLES(T, A)

// I(table, record, member, target table, least, what it is if the member is no index there or less than
// `least`). Of a table that is empty, the records that kernels read all the same are checked too.
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

// Where a table is: offsets count 32-bit words from the start of the scene's array. A table that the scene
// does not need has count 0.
#define TABLE_SPAN_FIELDS(F) \
  F(int, count)              \
  F(uint, offset)

#define TABLE_SPAN_FIELD(F, name, record, least, what) F(TableSpan, name)
#define TABLE_SPANS_FIELDS(F) SCENE_TABLES(TABLE_SPAN_FIELD, F)

// Everything that is not a record of a table.
#define SCENE_HEADER_FIELDS(F)                                                                       \
  F(ulong, features)     /* FEATURE_* bits */                                                        \
  F(uint, families)      /* of its materials, 1 << FAMILY_* */                                       \
  F(uint, textured)      /* bits 1 << TEXTURED_* of the fields for which a material has a texture */ \
  F(uint, texture_kinds) /* bits 1 << TEXTURE_* of the textures there are */                         \
  F(int, intersector)    /* INTERSECTOR_* */                                                         \
  F(Camera, camera)                                                                                  \
  F(FilmParameters, film)                                                                            \
  F(SamplerParameters, sampler)                                                                      \
  F(IntegratorParameters, integrator)                                                                \
  F(Adjustable, adjustable)                                                                          \
  F(int, environment)       /* index of the environment light, or -1 */                              \
  F(uint, light_kinds)      /* bits 1 << LIGHT_* of the lights there are */                          \
  F(int, light_cut)         /* nodes that have no parent */                                          \
  F(int, light_tree_depth)  /* turns from there to the lowest leaf of the hierarchy of lights */     \
  F(int, light_leaf_turns)  /* turns to any of a leaf's lights, 0 if leaves have one light each */   \
  F(int, matte_count)       /* FEATURE_MATTES: numbers of mattes are at most that */                 \
  F(int, camera_medium)     /* the medium in which the camera is */                                  \
  F(int, dropped_triangles) /* without area in single precision: left out, and said */               \
  F(uint, edges_camera)     /* FEATURE_LIGHT_EDGES: camera_key of the one that sees the tables' */   \
  F(int, sees_edges)        /* ... 1 if that is the camera, else 0: the tables do not count */       \
  F(int, duplicate_lights)  /* light triangles that repeat another one: they do not shine twice */   \
  F(TableSpans, tables)

// X(struct, field list): for tests and for serialisation.
#define SHARED_STRUCTS(X)                               \
  X(Triangle, TRIANGLE_FIELDS)                          \
  X(VertexNormals, VERTEX_NORMALS_FIELDS)               \
  X(VertexUvs, VERTEX_UVS_FIELDS)                       \
  X(VertexColours, VERTEX_COLOURS_FIELDS)               \
  X(Quadric, QUADRIC_FIELDS)                            \
  X(Instance, INSTANCE_FIELDS)                          \
  X(PrimitiveGroup, PRIMITIVE_GROUP_FIELDS)             \
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
  X(Polygon, POLYGON_FIELDS)                            \
  X(PolygonCorner, POLYGON_CORNER_FIELDS)               \
  X(LightEdgePixel, LIGHT_EDGE_PIXEL_FIELDS)            \
  X(LightEdge, LIGHT_EDGE_FIELDS)                       \
  X(BvhNode, BVH_NODE_FIELDS)                           \
  X(TriangleLeaf, TRIANGLE_LEAF_FIELDS)                 \
  X(QuadricLeaf, QUADRIC_LEAF_FIELDS)                   \
  X(Corner, CORNER_FIELDS)                              \
  X(LtcCell, LTC_CELL_FIELDS)                           \
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

PENUMBRA_NAMESPACE_END
#endif
