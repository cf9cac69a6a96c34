// The portable kernels as the tests compile them: with every feature, on LANES lanes.
#pragma once

#define FEATURES FEATURE_ALL
#include "kernels/block/block_compact.h"
#include "kernels/block/block_sort.h"
#include "kernels/block/block_surface.h"
#include "kernels/bsdf/bsdf.h"
#include "kernels/bsdf/material_tree.h"
#include "kernels/camera/camera.h"
#include "kernels/camera/lens_camera.h"
#include "kernels/intersect/bvh.h"
#include "kernels/intersect/quadric.h"
#include "kernels/intersect/surface.h"
#include "kernels/intersect/triangle.h"
#include "kernels/light/light.h"
#include "kernels/light/light_tree.h"
#include "kernels/light/mis.h"
#include "kernels/light/projected_light.h"
#include "kernels/light/spherical_triangle.h"
#include "kernels/math/frame.h"
#include "kernels/math/math.h"
#include "kernels/sampler/filter.h"
#include "kernels/sampler/sampler.h"
