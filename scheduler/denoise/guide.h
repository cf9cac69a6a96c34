// Runs the filter of non-local means over whole images.
#pragma once

#include <array>
#include <functional>

#include "scheduler/denoise/denoise.h"
#include "scheduler/denoise/denoise_device.h"

namespace penumbra {

/// The guide of kernels/denoise/denoise_task.h. Of fewer than three planes, some are repeated.
Planes make_guide(const Planes& values, const Planes& variances, float variance_scale, const Planes& valid);

/// Filters `sources` (at most MAX_SOURCES planes) with the weights of `guide`.
Expected<Planes> filter(DenoiseDevice& device, const Planes& guide, const Planes& sources,
                        const NlMeansOptions& options);

/// Filters colours with the weights of a guide.
using ColorFilter = std::function<Expected<Planes>(const Planes& guide, const Planes& color)>;
/// The image, filtered with its own weights.
Expected<Planes> self_filtered(const DenoiseInput& input, const ColorFilter& filter);
/// Both halves, each filtered with the weights of the other.
Expected<std::array<Planes, 2>> cross_filtered(const DenoiseInput& input, const ColorFilter& filter);
/// The mean of two denoised halves, and the variance that is left.
DenoisedImage joined(const Planes& a, const Planes& b);

/// The planes [first, first + count).
Planes some_planes(const Planes& image, int first, int count);

/// (a + b) / 2, and (a - b)^2 / 4.
Planes mean_of(const Planes& a, const Planes& b);
Planes quarter_of_squared_difference(const Planes& a, const Planes& b);

/// The means of (2 radius + 1)^2 pixels, of those that exist.
Planes box_mean(const Planes& image, int radius);

}  // namespace penumbra
