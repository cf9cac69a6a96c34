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
// Variances are those of noise_model.h, which are larger than the images' own where these are estimates.
// Low-discrepancy samplers have less error than the variance of their samples suggests. In both cases z is
// too small, and the test is stricter with what it calls a difference than its significance says.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/metrics/image_pair.h"
#include "scheduler/image/metrics/noise_model.h"

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

/// Numbers of samples per pixel from which the variances of an image are estimated.
struct SampleCounts {
  double least = 0, most = 0, mean = 0;
};

struct ZTest {
  /// Number of values with a variance (pixels times channels), to which z refers below.
  std::uint64_t values = 0;
  std::uint64_t exact_equal = 0;      ///< no variance in either image and equal up to rounding; left out
  std::uint64_t exact_different = 0;  ///< no variance in either image but different; each is an inconsistency
  std::uint64_t invalid_variances = 0;  ///< negative or not finite; each is an inconsistency
  std::uint64_t unknown_variances = 0;  ///< too few samples for an estimate; left out
  std::optional<SampleCounts> image_samples, reference_samples;  ///< none: the variances count as exact
  /// Fractions of |z| above 1.96 and 2.58, and the mean of z^2. 0.05, 0.0099 and 1 are expected, less if
  /// variances are estimates.
  double share_above_1_96 = 0, share_above_2_58 = 0;
  double mean_square = 0;
  ZExtreme largest;                    ///< the largest |z|
  std::uint64_t blocks = 0;            ///< blocks times channels
  ZExtreme block_chi_square;           ///< the block and channel with the least likely chi-square statistic
  ZExtreme block_mean;                 ///< the block and channel with the largest |sum d / sqrt(sum Var)|
  std::vector<double> channel_mean_z;  ///< the statistic of the whole image
  ZExtreme image_mean;                 ///< the largest of those
  std::vector<double> channel_chi_square_p;  ///< chi-square over all z of a channel; not part of the verdict
  /// The difference that the test would find in 90 % of all cases, relative to the mean of all channels: of a
  /// channel's mean over the image (the largest), and over a block (the median). Not finite: unknown.
  double visible_image_difference = 0, visible_block_difference = 0;
  ZTestOptions options;
  bool consistent = false;  ///< no test found a difference
  /// Why the test cannot tell a difference from noise; empty: it can.
  std::string too_few_samples;

  /// A difference is a p below this. There are four tests.
  [[nodiscard]] double limit() const { return options.significance / 4; }
};

/// The variance of the values in the image's layer `layer`, in the order of `pair`. For the beauty layer it
/// is the layer `variance` (variance.R and so on), for others `variance.NAME`. Errors: there is no such
/// layer, or its size is wrong.
Expected<std::vector<float>> variance_layer(const Image& image, const ImagePair& pair,
                                            std::string_view layer = {});

/// The same from a separate image: its variance layer if it has one, else its R, G, B or grey channels.
Expected<std::vector<float>> variance_image(const Image& image, const ImagePair& pair,
                                            std::string_view layer = {});

/// The numbers of samples of an image's pixels, from its channel samples.Y; empty if it has none.
std::vector<float> samples_per_pixel(const Image& image);

/// Performs the test. With two references the noise of the reference is that of their mean. Errors: a wrong
/// length, both without variances, a block size below 1.
Expected<ZTest> z_test(const ImagePair& pair, const ImageNoise& image, const ImageNoise& reference,
                       const ZTestOptions& options = {});

/// z of each value, in the layout of `pair.image`. NaN if there is none: not finite, unknown variance, or
/// equal without variance. Infinite if different without variance.
std::vector<float> z_values(const ImagePair& pair, const ImageNoise& image, const ImageNoise& reference,
                            int block = ZTestOptions{}.block);

}  // namespace penumbra
