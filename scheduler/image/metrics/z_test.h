// A statistical test whether two images differ only by their noise.
//
// For each value z = (A - B) / sqrt(Var A + Var B + r^2). The variances are those of the means (the layer
// `variance` of Penumbra's images; 0 for an exact reference). r = 2^-18 max(|A|, |B|) allows for the rounding
// of float arithmetic. If the images differ only by noise and the variances are right, z is standard normal.
// There are four tests, each at a fourth of the significance, with Bonferroni's correction for its number of
// values:
//   - the largest |z| (it finds a wrong pixel),
//   - the chi-square statistic of z^2 over blocks of pixels, for each channel separately, because the
//     channels of a pixel share their paths and are not independent (it finds regions noisier than their
//     variance, or slightly wrong everywhere),
//   - sum d / sqrt(sum Var) over those blocks (it finds regions that are too bright or dark, with far more
//     power than single values, and is close to normal even if single values are not),
//   - the same over the whole image.
// A mean of few samples from a skewed distribution is not normal, and the variance is itself an estimate. So
// with less than some hundred samples per pixel the first two tests report too many differences.
// Low-discrepancy samplers have less error than the variance of their samples suggests. Then z is too small,
// and the test is less strict than it could be.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/metrics/image_pair.h"

namespace penumbra {

struct ZTestOptions {
  /// Probability that images which differ only by noise are reported as inconsistent.
  double significance = 0.01;
  int block = 16;  ///< side of a block in pixels, at least 1
};

/// The most extreme value, block or image, in film coordinates, and the probability that any is so extreme.
struct ZExtreme {
  double z = 0;  ///< or the chi-square statistic
  double dof = 0;
  int x = 0, y = 0;  ///< the pixel, or the block's upper left pixel
  std::size_t channel = 0;
  double p = 1;  ///< two-sided (chi-square: upper tail), times the number of values, at most 1
};

struct ZTest {
  /// Number of values with a variance (pixels times channels), to which z refers below.
  std::uint64_t values = 0;
  std::uint64_t exact_equal = 0;      ///< no variance in either image and equal up to rounding; left out
  std::uint64_t exact_different = 0;  ///< no variance in either image but different; each is an inconsistency
  std::uint64_t invalid_variances = 0;  ///< negative or not finite; each is an inconsistency
  double share_above_1_96 = 0;          ///< fraction of |z| above 1.96; 0.05 expected
  double share_above_2_58 = 0;          ///< fraction above 2.58; 0.0099 expected
  double mean_square = 0;               ///< mean of z^2; 1 expected
  ZExtreme largest;                     ///< the largest |z|
  std::uint64_t blocks = 0;             ///< blocks times channels
  ZExtreme block_chi_square;            ///< the block and channel with the least likely chi-square statistic
  ZExtreme block_mean;                  ///< the block and channel with the largest |sum d / sqrt(sum Var)|
  std::vector<double> channel_mean_z;   ///< the statistic of the whole image
  ZExtreme image_mean;                  ///< the largest of those
  std::vector<double> channel_chi_square_p;  ///< chi-square over all z of a channel; not part of the verdict
  ZTestOptions options;
  bool consistent = false;
};

/// The variance of the values in the image's layer `layer`, in the order of `pair`. For the beauty layer it
/// is the layer `variance` (variance.R and so on), for others `variance.NAME`. Errors: there is no such
/// layer, or its size is wrong.
Expected<std::vector<float>> variance_layer(const Image& image, const ImagePair& pair,
                                            std::string_view layer = {});

/// The same from a separate image: its variance layer if it has one, else its R, G, B or grey channels.
Expected<std::vector<float>> variance_image(const Image& image, const ImagePair& pair,
                                            std::string_view layer = {});

/// Performs the test. `image_variance` and `reference_variance` have the layout of `pair.image`; an empty one
/// means 0. With two references the latter is the variance of their mean. Errors: a wrong length, both empty,
/// a block size below 1, no value that has a variance or differs.
Expected<ZTest> z_test(const ImagePair& pair, std::span<const float> image_variance,
                       std::span<const float> reference_variance, const ZTestOptions& options = {});

/// z of each value, in the layout of `pair.image`. NaN if there is none: not finite, or equal without
/// variance. Infinite if different without variance.
std::vector<float> z_values(const ImagePair& pair, std::span<const float> image_variance,
                            std::span<const float> reference_variance);

}  // namespace penumbra
