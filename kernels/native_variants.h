// Which feature masks native code is precompiled for. Each set names one object library of CMakeLists.txt.
#pragma once

#include "kernels/features.h"

// What most scenes of diffuse triangle meshes need; and everything. Scenes are traced whole or through the
// BVH.
#define NATIVE_FEATURES_core (FEATURE_PATH | FEATURE_LAYERS | FEATURE_SAMPLERS)
#define NATIVE_FEATURES_core_bvh (NATIVE_FEATURES_core | FEATURE_BVH)
// Paths in glossy meshes with vertex normals: 1.4 times as fast as with everything (the Cornell box,
// AVX-512).
#define NATIVE_FEATURES_mesh (NATIVE_FEATURES_core | FEATURE_PHONG | FEATURE_SHADING_NORMALS)
#define NATIVE_FEATURES_mesh_bvh (NATIVE_FEATURES_mesh | FEATURE_BVH)
// Direct light of diffuse and glossy meshes, closed forms of polygon lights among it.
#define NATIVE_FEATURES_polygons                                                                 \
  (FEATURE_DIRECT | FEATURE_PHONG | FEATURE_PROJECTED | FEATURE_POLYGONS | FEATURE_SOLID_ANGLE | \
   FEATURE_LAYERS | FEATURE_SAMPLERS | FEATURE_RATIO)
#define NATIVE_FEATURES_polygons_bvh (NATIVE_FEATURES_polygons | FEATURE_BVH)
#define NATIVE_FEATURES_all (FEATURE_ALL & ~FEATURE_BVH)
#define NATIVE_FEATURES_all_bvh FEATURE_ALL

/// X(set), the smallest first. No image depends on the set, so builds that look for mistakes have the largest
/// alone.
#ifdef PENUMBRA_ONE_NATIVE_SET
  #define NATIVE_FEATURE_SETS(X) X(all) X(all_bvh)
#else
  #define NATIVE_FEATURE_SETS(X) \
    X(core) X(core_bvh) X(mesh) X(mesh_bvh) X(polygons) X(polygons_bvh) X(all) X(all_bvh)
#endif
