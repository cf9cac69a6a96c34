// The stages of one family of BSDFs, compiled like the workers' kernels.
#pragma once

#include "kernels/scene_types.h"

namespace penumbra {

/// Evaluates, or samples, the closure for LANES pairs of random directions, `groups` times; a number that
/// depends on all results.
using BsdfStages = float(const Closure& closure, bool sample, int groups);

BsdfStages bsdf_stages_avx2, bsdf_stages_avx512;

}  // namespace penumbra
