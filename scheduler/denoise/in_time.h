// Blends the denoised frames of a shot with those before and after them, so that they flicker less.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"

namespace penumbra {

constexpr int kTimeRadius = 2;  ///< frames before, and after, by default
constexpr int kMostTimeRadius = 8;

/// Frames beside one, the nearest first. They end where a file is missing.
struct FramesBeside {
  std::vector<const Image*> before, after;
};

/// Metadata of a blended frame: the film hashes of the frames beside it, as of hashes_of().
inline constexpr const char* kFramesBefore = "penumbra:frames_before";
inline constexpr const char* kFramesAfter = "penumbra:frames_after";

/// The film hashes of images, separated by blanks; "?" for those without.
std::string hashes_of(const std::vector<const Image*>& images);

/// The frame with light of those beside it in R, G, B; what was there is then in still.R/G/B. error.R/G/B is
/// the variance that is left if the noise of frames is independent. All images are outcomes of denoise_image,
/// blended or not: of those that are, still.R/G/B counts. So the order of blending does not matter.
///
/// A pixel is followed along the layer `motion` from frame to frame, as long as it comes back within a pixel,
/// and depth and normal stay. There the light of the other frame, divided by albedo, has a weight that falls
/// with the squared difference of the patches around both beyond their remaining noise, as in non-local
/// means, and with its own remaining noise.
///
/// Errors: a frame is of another size; it lacks motion.X/Y/Z/W or error.R/G/B. `problem` of a frame beside
/// begins with its number, such as "frame 2 before:".
Expected<Image> blended_in_time(const Image& frame, const FramesBeside& beside);

/// What a denoised frame lacks to be blended or to be beside one that is; empty: nothing.
std::string lacks_for_time(const Image& denoised);

}  // namespace penumbra
