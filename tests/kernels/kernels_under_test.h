// The portable kernels as the tests compile them: with every feature, on LANES lanes.
#pragma once

#define FEATURES FEATURE_ALL
#include "kernels/bsdf.h"
#include "kernels/bvh.h"
#include "kernels/camera.h"
#include "kernels/filter.h"
#include "kernels/frame.h"
#include "kernels/light.h"
#include "kernels/math.h"
#include "kernels/mis.h"
#include "kernels/quadric.h"
#include "kernels/sampler.h"
#include "kernels/spherical_triangle.h"
#include "kernels/surface.h"
#include "kernels/triangle.h"
