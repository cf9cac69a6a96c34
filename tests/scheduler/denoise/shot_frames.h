// Noisy frames of made-up shots, for tests of what is done in time.
#pragma once

#include <cstdint>
#include <functional>

#include "scheduler/image/image.h"

namespace penumbra {

constexpr int kFrameWidth = 64, kFrameHeight = 48;

/// What a frame shows at a pixel: radiance, the same in all channels.
using Truth = std::function<float(int x, int y)>;

/// A frame with noise of standard deviation sigma: R, G, B, variance, motion, albedo 1, normal z, depth 5,
/// and the halves of its samples. All points move right by `speed` pixels a frame. Its film hash is the seed.
Image frame_of(const Truth& truth, float sigma, std::uint32_t seed, float speed = 0);

}  // namespace penumbra
