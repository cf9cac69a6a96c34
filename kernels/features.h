// The feature mask: one bit for each feature that a scene and its integrator need. OpenCL kernels are
// compiled for exactly these bits. Native code is compiled for all features and skips at run time what a
// scene does not need. Tables and fields of a masked-out feature are neither allocated nor uploaded nor sent.
#ifndef PENUMBRA_FEATURES_H
#define PENUMBRA_FEATURES_H
#include "kernels/lang.h"

PENUMBRA_NAMESPACE_BEGIN

// X(name, description for users)
#define PENUMBRA_FEATURES(X)                                            \
  X(PATH, "path integrator")                                            \
  X(DIRECT, "direct integrator")                                        \
  X(BVH, "bounding volume hierarchy")                                   \
  X(TRANSMISSION, "paths through surfaces into other media")            \
  X(SHADING_NORMALS, "interpolated vertex normals")                     \
  X(QUADRICS, "spheres and disks")                                      \
  X(MIXED_FAMILIES, "several families of BSDFs")                        \
  X(WHITTED, "whitted integrator")                                      \
  X(SOLID_ANGLE, "sampling of triangle lights by solid angle")          \
  X(LAYERS, "albedo, normal and depth layers")                          \
  X(SAMPLERS, "samplers other than Owen-scrambled Sobol")               \
  X(PROJECTED, "sampling of triangle lights by projected solid angle")  \
  X(POLYGONS, "polygon lights in closed form")                          \
  X(LOOK_THROUGH, "hidden emitters that the camera looks through")      \
  X(UV, "texture coordinates and tangents")                             \
  X(TEXTURES, "textures")                                               \
  X(NESTED, "BSDFs that hold others, and surfaces seen through")        \
  X(BENT, "normal maps, bump maps and turned tangents")                 \
  X(OCCLUSION, "ambient and reflection occlusion integrators")          \
  X(LTC, "glossy BSDFs under polygon lights")                           \
  X(LIGHT_TREE, "choice among lights by their contribution")            \
  X(INSTANCES, "instances of groups of shapes")                         \
  X(CAMERA, "lenses, parallel projection and distorted images")         \
  X(LIGHT_TEXTURES, "lights with textures")                             \
  X(CYLINDERS, "cylinders")                                             \
  X(COVERAGE, "alpha")                                                  \
  X(MATTES, "objects and materials of pixels")                          \
  X(PARTS, "parts of the light of paths alone")                         \
  X(MEDIA, "participating media")                                       \
  X(PANES, "thin panes that shadow rays pass")                          \
  X(FLAT_GLASS, "plates of glass that shadow rays pass")                \
  X(LIGHT_EDGES, "edges of lights that the camera sees")                \
  X(PHOTONS, "photon maps")                                             \
  X(DENOISING, "half buffers and variances of layers, for denoising")   \
  X(POSITION_LAYER, "position layer")                                   \
  X(UV_LAYER, "layer of texture coordinates")                           \
  X(GEOMETRIC_NORMAL_LAYER, "geometric normal layer")                   \
  X(SHAPE_LAYER, "layer of shape IDs")                                  \
  X(DIRECT_LAYER, "direct light layer")                                 \
  X(INDIRECT_LAYER, "indirect light layer")                             \
  X(MOTION, "motion while the shutter is open")                         \
  X(MOTION_LAYER, "layer of motion")                                    \
  X(DISPERSION, "glass whose refractive index differs between colours") \
  X(PANORAMA, "panoramic cameras")                                      \
  X(EMITTING_MEDIA, "media that emit")                                  \
  X(CURVES, "curves")                                                   \
  X(INTERIORS, "scattering below surfaces, and coloured glass")         \
  X(SPREAD, "flat lights that shine into a cone")                       \
  X(TANGENTS, "tangents of vertices")                                   \
  X(COAT_NORMALS, "coats with normals of their own")

#define NUMBER_FEATURE(name, text) NUMBER_OF_##name,
enum { PENUMBRA_FEATURES(NUMBER_FEATURE) FEATURE_COUNT };
#undef NUMBER_FEATURE
#define FEATURE_BIT(name, text) FEATURE_##name = (ulong)1 << NUMBER_OF_##name,
/// A mask has 64 bits. The highest bit belongs to no feature; path_state.h uses it as a flag, see ALL_OF.
ENUM_OF_ULONG{PENUMBRA_FEATURES(FEATURE_BIT) FEATURE_ALL = ((ulong)1 << FEATURE_COUNT) - 1};
#undef FEATURE_BIT

// The build of kernels for one scene defines FEATURES as a number. Without it, kernels are compiled for all
// scenes.
#ifdef FEATURES
  #if (FEATURES) == 0
    #error "FEATURES is 0: kernels for one scene need its features"
  #endif
  #define COMPILED_FEATURES ((ulong)(FEATURES))
  #define FOR_EVERY_SCENE false
#else
  #define COMPILED_FEATURES ((ulong)FEATURE_ALL)
  #define FOR_EVERY_SCENE true
#endif

// HAS is a compile-time constant. Compilers drop the code behind `if (HAS(POLYGONS) && ...)` where it is
// false, and functions that nothing else calls.
#define HAS(name) ((COMPILED_FEATURES & FEATURE_##name) != 0)
/// Whether the kernels contain the brute-force search. Small scenes test every primitive, large ones traverse
/// the BVH. Kernels for one scene contain only the search that it needs; kernels for all scenes contain both.
#define HAS_BRUTE_FORCE (!HAS(BVH) || FOR_EVERY_SCENE)
/// Whether the kernels have the feature and the scene needs it. Native kernels have all features and must
/// skip those that the scene does not need.
#define NEEDS(scene, name) (HAS(name) && (SCENE_FEATURES(&(scene)->header) & FEATURE_##name) != 0)
#define SCENE_FEATURES(h) NEEDED(COMPILED_FEATURES, (h)->features)

PENUMBRA_NAMESPACE_END
#endif
