// Error metrics of two images: one number for each channel and one overall.
//
// d = A - B, with a value A of the image and B of the reference, in the images' unit (radiance for a render).
// N is the number of pixels that are finite in all images. With two independent references, B is their mean,
// and squares d^2 are (A - B1)(A - B2): see ImagePair::squared_difference. All sums are compensated sums in
// double precision.
#pragma once

#include <vector>

#include "scheduler/image/metrics/image_pair.h"

namespace penumbra {

/// Bounds the relative error of black pixels; the usual value in the rendering literature.
constexpr double kRelativeEpsilon = 0.01;
/// The fraction of pixels that the trimmed relMSE leaves out.
constexpr double kTrimmedShare = 0.001;
/// The side in pixels of the blocks whose means block_relative_mse compares.
constexpr int kErrorBlock = 4;

/// A metric for each channel and overall; unless stated otherwise, the latter is the mean over channels.
struct ChannelValues {
  double overall = 0;
  std::vector<double> channels;
};

/// The means of A and of the reference.
ChannelValues image_mean(const ImagePair& pair);
ChannelValues reference_mean(const ImagePair& pair);

/// Mean of d: the signed mean error, in which independent noise cancels.
ChannelValues bias(const ImagePair& pair);

/// Mean of d / mean of B. Infinite or NaN if the mean of B is 0. Overall: the same with means over all
/// channels.
ChannelValues relative_bias(const ImagePair& pair);

/// MSE: mean of d^2. Unit: radiance^2. With two references it may be slightly negative because of noise.
ChannelValues mean_squared_error(const ImagePair& pair);

/// relMSE: mean of d^2 / (B^2 + epsilon); terms with d^2 = 0 are 0. It has no unit; epsilon is in radiance^2.
/// Rousselle, Knaus, Zwicker 2011, "Adaptive sampling and reconstruction using greedy error minimization".
ChannelValues relative_mse(const ImagePair& pair, double epsilon = kRelativeEpsilon);

/// relMSE of the means of kErrorBlock x kErrorBlock pixels; see block_means. NaN if no block is finite.
ChannelValues block_relative_mse(const ImagePair& pair, double epsilon = kRelativeEpsilon);

/// relMSE without the floor(share * N) pixels with the largest terms. It shows the error of an image apart
/// from its fireflies. For a channel its own largest terms are left out; overall those with the largest mean
/// over channels. It is biased low, so report it together with the untrimmed relMSE. share is in [0, 1).
ChannelValues trimmed_relative_mse(const ImagePair& pair, double epsilon = kRelativeEpsilon,
                                   double share = kTrimmedShare);

/// The number of pixels that the trimmed relMSE leaves out.
std::uint64_t trimmed_pixels(const ImagePair& pair, double share = kTrimmedShare);

/// MAPE as a fraction (1 is 100 %): mean of |d| / (|B| + epsilon); terms with d = 0 are 0.
ChannelValues mean_absolute_percentage_error(const ImagePair& pair, double epsilon = kRelativeEpsilon);

/// SMAPE as a fraction, in [0, 1]: mean of |d| / (|A| + |B| + epsilon); terms with d = 0 are 0. Vogels et al.
/// 2018, "Denoising with kernel prediction and asymmetric loss functions".
ChannelValues symmetric_mean_absolute_percentage_error(const ImagePair& pair,
                                                       double epsilon = kRelativeEpsilon);

/// PSNR in dB: 10 log10(P^2 / MSE), where P is the largest |B| of the channel, or over all channels. Infinite
/// for equal images.
ChannelValues peak_signal_to_noise_ratio(const ImagePair& pair);

/// The largest |d| and the first pixel with it, in film coordinates.
struct LargestDifference {
  double value = 0;
  int x = 0, y = 0;
  std::size_t channel = 0;
};
LargestDifference largest_difference(const ImagePair& pair);
/// Overall: the largest over the channels.
ChannelValues largest_differences(const ImagePair& pair);

}  // namespace penumbra
