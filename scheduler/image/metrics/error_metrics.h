// How large the difference of two images is, in one number for each channel and one for all.
//
// d = A - B for a value A of the image and B of the reference, in the images' unit (radiance, for a render).
// N pixels, those that are finite in all images. With two independent references, B is their mean, and
// squares d^2 are (A - B1)(A - B2): see ImagePair::squared_difference. All sums are compensated sums in
// double.
#pragma once

#include <vector>

#include "scheduler/image/metrics/image_pair.h"

namespace penumbra {

/// Keeps the relative error of black pixels finite; the usual one in the literature on rendering.
constexpr double kRelativeEpsilon = 0.01;
/// The share of pixels that the trimmed relMSE leaves out.
constexpr double kTrimmedShare = 0.001;
/// Side in pixels of the blocks whose means block_relative_mse compares.
constexpr int kErrorBlock = 4;

/// A metric of each channel, and of all: unless said otherwise, the mean over channels.
struct ChannelValues {
  double overall = 0;
  std::vector<double> channels;
};

/// Mean of A and of the reference.
ChannelValues image_mean(const ImagePair& pair);
ChannelValues reference_mean(const ImagePair& pair);

/// Mean of d: the signed mean error. Independent noise cancels in it.
ChannelValues bias(const ImagePair& pair);

/// Mean of d / mean of B. Infinite or NaN where the mean of B is 0. Overall: the same over all channels
/// together.
ChannelValues relative_bias(const ImagePair& pair);

/// MSE: mean of d^2. Unit: radiance^2. Not below 0, but for noise where there are two references.
ChannelValues mean_squared_error(const ImagePair& pair);

/// relMSE: mean of d^2 / (B^2 + epsilon), with terms where d^2 = 0 as 0. Without unit, epsilon: radiance^2.
/// Rousselle,
/// Knaus, Zwicker 2011, "Adaptive sampling and reconstruction using greedy error minimization".
ChannelValues relative_mse(const ImagePair& pair, double epsilon = kRelativeEpsilon);

/// relMSE of the means of kErrorBlock x kErrorBlock pixels: see block_means. NaN if no block is finite.
ChannelValues block_relative_mse(const ImagePair& pair, double epsilon = kRelativeEpsilon);

/// relMSE without the floor(share * N) pixels of the largest terms, which shows the error of the rest of an
/// image with fireflies. A channel's: of its own largest terms; overall: of the largest means over channels.
/// Biased low, of course: report it beside the untrimmed. share in [0, 1).
ChannelValues trimmed_relative_mse(const ImagePair& pair, double epsilon = kRelativeEpsilon,
                                   double share = kTrimmedShare);

/// How many pixels that leaves out.
std::uint64_t trimmed_pixels(const ImagePair& pair, double share = kTrimmedShare);

/// MAPE as a fraction (1 is 100 %): mean of |d| / (|B| + epsilon), with terms where d = 0 as 0.
ChannelValues mean_absolute_percentage_error(const ImagePair& pair, double epsilon = kRelativeEpsilon);

/// SMAPE as a fraction, in [0, 1]: mean of |d| / (|A| + |B| + epsilon), with terms where d = 0 as 0. Vogels
/// et al. 2018, "Denoising with kernel prediction and asymmetric loss functions".
ChannelValues symmetric_mean_absolute_percentage_error(const ImagePair& pair,
                                                       double epsilon = kRelativeEpsilon);

/// PSNR in dB: 10 log10(P^2 / MSE), P the largest |B| of the channel, or of all. Infinite for equal images.
ChannelValues peak_signal_to_noise_ratio(const ImagePair& pair);

/// The largest |d|, and the first pixel that has it, in film coordinates.
struct LargestDifference {
  double value = 0;
  int x = 0, y = 0;
  std::size_t channel = 0;
};
LargestDifference largest_difference(const ImagePair& pair);
/// Overall: the largest of the channels.
ChannelValues largest_differences(const ImagePair& pair);

}  // namespace penumbra
