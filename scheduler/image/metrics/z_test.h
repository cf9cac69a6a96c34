// Are two images the same up to their noise?
//
// z = (A - B) / sqrt(Var A + Var B + r^2) of each value, where the variances are those of the means (the
// layer `variance` of Penumbra's images; 0 for an exact reference) and r = 2^-18 max(|A|, |B|) stands for the
// rounding of float arithmetic. If only noise differs and the variances are right, z is standard normal. Four
// things are looked at, each at a fourth of the significance and corrected after Bonferroni for its number of
// values:
//   - the largest |z| (a pixel that is wrong),
//   - the chi-square of z^2 over blocks of pixels, channel by channel, as the channels of a pixel share their
//     paths and are not independent (regions noisier than they say, or slightly wrong everywhere),
//   - sum d / sqrt(sum Var) over those blocks (regions that are too bright or dark: far more power than the
//     single values, and close to normal where they are not),
//   - the same over the whole image.
// Few samples of skewed distributions are not normal and the variance is itself estimated: with less than
// some hundred samples per pixel the first two see more than there is. Low-discrepancy samplers are better
// than the variance of their samples says: z is then too small, and the test asks for less than it could.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/metrics/image_pair.h"

namespace penumbra {

struct ZTestOptions {
  double significance = 0.01;  ///< chance that images which differ by noise alone are found inconsistent
  int block = 16;              ///< side of a block in pixels, at least 1
};

/// A value, block or image that stands out most, in film coordinates, and the chance that any stands out so
/// much.
struct ZExtreme {
  double z = 0;  ///< or the chi-square statistic
  double dof = 0;
  int x = 0, y = 0;  ///< the pixel, or the block's upper left pixel
  std::size_t channel = 0;
  double p = 1;  ///< two-sided (chi-square: upper tail), times the number of values, at most 1
};

struct ZTest {
  std::uint64_t values = 0;           ///< with a variance: pixels times channels, the z below
  std::uint64_t exact_equal = 0;      ///< no variance on either side, equal up to rounding; left out
  std::uint64_t exact_different = 0;  ///< no variance on either side, yet different; each is an inconsistency
  std::uint64_t invalid_variances = 0;       ///< negative or not finite; each is an inconsistency
  double share_above_1_96 = 0;               ///< of |z|; 0.05 expected
  double share_above_2_58 = 0;               ///< 0.0099 expected
  double mean_square = 0;                    ///< of z; 1 expected
  ZExtreme largest;                          ///< the largest |z|
  std::uint64_t blocks = 0;                  ///< blocks times channels
  ZExtreme block_chi_square;                 ///< the block and channel of the least likely chi-square
  ZExtreme block_mean;                       ///< ... and of the largest sum d / sqrt(sum Var)
  std::vector<double> channel_mean_z;        ///< that of the whole image
  ZExtreme image_mean;                       ///< the largest of those
  std::vector<double> channel_chi_square_p;  ///< of all z of a channel; not part of the verdict
  ZTestOptions options;
  bool consistent = false;
};

/// The variance of the values that `layer` of the image has, in the order of `pair`: the layer `variance`, as
/// variance.R and so on, for the beauty, `variance.NAME` for others. Errors: there is none, or the wrong
/// size.
Expected<std::vector<float>> variance_layer(const Image& image, const ImagePair& pair,
                                            std::string_view layer = {});

/// The same from an image that holds nothing else: its variance layer if it has one, else its R, G, B or
/// grey.
Expected<std::vector<float>> variance_image(const Image& image, const ImagePair& pair,
                                            std::string_view layer = {});

/// `image_variance` and `reference_variance` have the layout of `pair.image`; an empty one means 0. The
/// reference's is that of the mean of both where there are two. Errors: a wrong length, both empty, a block
/// below 1, no value has a variance or differs.
Expected<ZTest> z_test(const ImagePair& pair, std::span<const float> image_variance,
                       std::span<const float> reference_variance, const ZTestOptions& options = {});

/// z of each value, in the layout of `pair.image`; NaN where there is none: not finite, or without variance
/// and equal. Infinite where there is no variance and a difference.
std::vector<float> z_values(const ImagePair& pair, std::span<const float> image_variance,
                            std::span<const float> reference_variance);

}  // namespace penumbra
