// Blends noisy frames of a shot with those before and after them, so that denoising sees less noise.
#pragma once

#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/denoise/motion.h"
#include "scheduler/image/image.h"

namespace penumbra {

constexpr int kTimeRadius = 2;  ///< frames before, and after, by default
constexpr int kMostTimeRadius = 8;

/// A noisy image, prepared to be blended with others.
struct FrameInTime {
  Image image;
  Planes halves[2] = {};  ///< 3 planes each: radiance of the halves of the samples, over albedo
  Planes noise = {};      ///< 3 planes: variance of the mean of both, over squared albedo
  Planes albedo = {};     ///< 3 planes
  SeenPoints points = {};
  Planes feature_noise = {};  ///< 7 planes: variance of albedo, normal, depth
};

/// What a noisy image lacks to be blended or to be beside one that is; empty: nothing.
std::string lacks_for_time(const Image& noisy);
/// `noisy` lacks nothing.
FrameInTime frame_in_time(Image noisy);

/// Frames beside one, of its size, the nearest first. They end where a file is missing.
struct FramesBeside {
  std::vector<const FrameInTime*> before, after;
};

/// The frame as if its samples were also those of the frames beside it: in R, G, B, half_a, half_b, variance,
/// albedo, normal, depth and their variances. Other layers stay.
///
/// A pixel is followed along the layer `motion` from frame to frame, as long as it comes back within a pixel,
/// and depth and normal stay. There the light of the other frame, divided by albedo, has a weight that falls
/// with the squared difference of the patches around both beyond their noise, as in non-local means: so light
/// that changes leaves no ghosts. Each half has the weights of the other. Albedo, normal and depth are
/// blended where these also differ by no more than their noise.
Image blended_in_time(const FrameInTime& frame, const FramesBeside& beside, std::size_t threads);

/// Metadata of a denoised frame: the film hashes of the frames beside it, as of hashes_of().
inline constexpr const char* kFramesBefore = "penumbra:frames_before";
inline constexpr const char* kFramesAfter = "penumbra:frames_after";

/// The film hashes of images, separated by blanks; "?" for those without.
std::string hashes_of(const std::vector<const Image*>& images);

}  // namespace penumbra
