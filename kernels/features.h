// The feature mask: what a scene and its integrator need. OpenCL kernels are compiled with exactly these
// bits; native code is compiled with all of them, and skips at run time what a scene does not need. What is
// masked out is neither allocated, uploaded nor shipped.
#ifndef PENUMBRA_FEATURES_H
#define PENUMBRA_FEATURES_H

// X(name, bit, what it is for people)
#define PENUMBRA_FEATURES(X)                                                  \
  X(PATH, 0x001, "path integrator")                                           \
  X(DIRECT, 0x002, "direct integrator")                                       \
  X(BVH, 0x004, "bounding volume hierarchy")                                  \
  X(TRANSMISSION, 0x008, "paths through surfaces into other media")           \
  X(SHADING_NORMALS, 0x010, "interpolated vertex normals")                    \
  X(QUADRICS, 0x020, "spheres and disks")                                     \
  X(MIXED_FAMILIES, 0x040, "several families of BSDFs")                       \
  X(WHITTED, 0x80, "whitted integrator")                                      \
  X(SOLID_ANGLE, 0x100, "sampling of triangle lights by solid angle")         \
  X(LAYERS, 0x200, "albedo, normal and depth layers")                         \
  X(SAMPLERS, 0x400, "samplers other than Owen-scrambled Sobol")              \
  X(PROJECTED, 0x800, "sampling of triangle lights by projected solid angle") \
  X(POLYGONS, 0x1000, "polygon lights in closed form")                        \
  X(LOOK_THROUGH, 0x2000, "hidden emitters that the camera looks through")    \
  X(UV, 0x8000, "texture coordinates and tangents")                           \
  X(TEXTURES, 0x10000, "textures")                                            \
  X(NESTED, 0x20000, "BSDFs that hold others, and surfaces seen through")     \
  X(BENT, 0x40000, "normal maps and bump maps")                               \
  X(OCCLUSION, 0x80000, "ambient and reflection occlusion integrators")       \
  X(LTC, 0x100000, "glossy BSDFs under polygon lights")                       \
  X(LIGHT_TREE, 0x200000, "choice among lights by their contribution")        \
  X(INSTANCES, 0x400000, "instances of groups of shapes")                     \
  X(CAMERA, 0x800000, "lenses, parallel projection and distorted images")     \
  X(LIGHT_TEXTURES, 0x1000000, "lights with textures")                        \
  X(CYLINDERS, 0x2000000, "cylinders")                                        \
  X(COVERAGE, 0x4000000, "alpha")                                             \
  X(MATTES, 0x8000000, "objects and materials of pixels")                     \
  X(PARTS, 0x10000000, "parts of the light of paths alone")                   \
  X(MEDIA, 0x20000000, "participating media")                                 \
  X(LIGHT_EDGES, 0x40000000, "edges of lights that the camera sees")

// Plain macros as well, since the preprocessor has to test them.
#define FEATURE_PATH 0x001
#define FEATURE_DIRECT 0x002
#define FEATURE_BVH 0x004
#define FEATURE_TRANSMISSION 0x008
#define FEATURE_SHADING_NORMALS 0x010
#define FEATURE_QUADRICS 0x020
#define FEATURE_MIXED_FAMILIES 0x040
#define FEATURE_WHITTED 0x80
#define FEATURE_SOLID_ANGLE 0x100
#define FEATURE_LAYERS 0x200
#define FEATURE_SAMPLERS 0x400
#define FEATURE_PROJECTED 0x800
#define FEATURE_POLYGONS 0x1000
#define FEATURE_LOOK_THROUGH 0x2000
#define FEATURE_UV 0x8000
#define FEATURE_TEXTURES 0x10000
#define FEATURE_NESTED 0x20000
#define FEATURE_BENT 0x40000
#define FEATURE_OCCLUSION 0x80000
#define FEATURE_LTC 0x100000
#define FEATURE_LIGHT_TREE 0x200000
#define FEATURE_INSTANCES 0x400000
#define FEATURE_CAMERA 0x800000
#define FEATURE_LIGHT_TEXTURES 0x1000000
#define FEATURE_CYLINDERS 0x2000000
#define FEATURE_COVERAGE 0x4000000
#define FEATURE_MATTES 0x8000000
#define FEATURE_PARTS 0x10000000
#define FEATURE_MEDIA 0x20000000
#define FEATURE_LIGHT_EDGES 0x40000000
#define FEATURE_ALL 0xffffffffu

/// A kernel source tests `HAS(POLYGONS)`; FEATURES comes from the build.
#define HAS(name) ((FEATURES & FEATURE_##name) != 0)
/// Small scenes are searched by testing every primitive, others through the hierarchy. Kernels for one scene
/// have its search alone, kernels for every scene both.
#define HAS_WHOLE (!HAS(BVH) || (FEATURES) == FEATURE_ALL)
/// Whether the scene needs it too: native kernels are compiled for more than their scene, and do not call
/// what it does not need.
#define NEEDS(scene, name) (HAS(name) && (SCENE_FEATURES(&(scene)->header) & FEATURE_##name) != 0u)
#define SCENE_FEATURES(h) NEEDED(FEATURES, (h)->features)

#endif
