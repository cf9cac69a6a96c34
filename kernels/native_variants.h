// Which feature masks native code is precompiled for. Each set names one object library of CMakeLists.txt.
#pragma once

#include "kernels/features.h"

// Every scene is traced whole or through the BVH, which have nothing in common; whatever else a scene lacks
// is left out by not calling its stages.
#define NATIVE_FEATURES_whole (FEATURE_ALL ^ FEATURE_BVH)
#define NATIVE_FEATURES_bvh FEATURE_ALL

/// X(set)
#define NATIVE_FEATURE_SETS(X) X(whole) X(bvh)
