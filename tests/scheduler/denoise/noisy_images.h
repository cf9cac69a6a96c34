// Images with known truth and Gaussian noise, for tests of denoising.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "scheduler/denoise/denoise.h"

namespace penumbra {

/// `truth(x, y, c)`; each half has independent noise of standard deviation `sigma` sqrt 2, so that their mean
/// has `sigma`. There are no features.
DenoiseInput noisy_image(int width, int height, const std::function<float(int x, int y, int c)>& truth,
                         float sigma, std::uint32_t seed);

/// Root of the mean square of what is left of `image` minus the truth.
double rms_error(const Planes& image, const std::function<float(int x, int y, int c)>& truth);

/// The widest native device, two threads.
std::unique_ptr<DenoiseDevice> test_device();

/// The rectangle of all planes.
Planes crop(const Planes& image, int x, int y, int width, int height);
DenoiseInput crop(const DenoiseInput& input, int x, int y, int width, int height);

}  // namespace penumbra
