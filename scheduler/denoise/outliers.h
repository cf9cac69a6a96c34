// Limits outliers (fireflies) before denoising: few samples that are so bright that filters spread them.
#pragma once

#include "scheduler/denoise/denoise.h"

namespace penumbra {

constexpr int kOutlierRadius = 2;  ///< of the pixels that tell an outlier

/// The input with halves that are nowhere brighter than the other half is around: than its value there, and
/// than its values within kOutlierRadius pixels by one standard deviation. This is biased. It darkens where
/// light comes by rare samples, normal noise by less than 2 % of its standard deviation, and what both halves
/// show not at all. Without halves, and for less than 5 x 5 pixels, the input stays as it is.
DenoiseInput without_outliers(DenoiseInput noisy);

}  // namespace penumbra
