// The variance that the difference of two images has if they are equal but for their noise.
//
// The variances of an image are mostly estimates from the image's own samples. A pixel that has not met a
// rare bright sample has too small a mean and too small a variance as well. Tests with these variances alone
// find differences where there are none, above all with few samples. So where the numbers of samples are
// known, the model takes
//   - the larger variance per sample of both images, because both sample the same light,
//   - for single values at least the mean variance of their block,
//   - in addition F |d| / n for light that one image lacks. F is the sum of that image's variances per sample
//     over the sum of its values: light that it has not met may come in portions as large as those it has
//     met.
// All three only increase variances, so tests are at most as strict as they say. Where the numbers of samples
// are unknown, variances count as exact.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "scheduler/image/metrics/compensated_sum.h"
#include "scheduler/image/metrics/image_pair.h"

namespace penumbra {

/// The noise of one image.
struct ImageNoise {
  /// Variances of the values, in the layout of ImagePair::image; empty: 0.
  std::span<const float> variance;
  /// For each pixel the number of samples from which its variances are estimated; empty: they are exact.
  std::span<const float> samples;

  [[nodiscard]] bool estimated() const { return !variance.empty() && !samples.empty(); }
};

/// Blocks with fewer samples of either image have no estimate of their variance.
constexpr double kLeastBlockSamples = 256;

/// One value of the difference.
struct Deviate {
  enum Kind {
    kNone,            ///< the pixel is not finite
    kInvalid,         ///< a variance is negative or not finite
    kUnknown,         ///< too few samples for an estimate of the variance
    kExactEqual,      ///< no variance in either image, and equal up to rounding
    kExactDifferent,  ///< no variance anywhere near, and different
    kNoisy
  } kind = kNone;
  double difference = 0, variance = 0;

  [[nodiscard]] double z() const;
};

class NoiseModel {
 public:
  /// All must outlive the model. `block` is the side of a block in pixels, at least 1.
  NoiseModel(const ImagePair& pair, const ImageNoise& image, const ImageNoise& reference, int block);

  /// Value i of the pair's values.
  [[nodiscard]] Deviate at(std::size_t i) const;

  /// Whether any variance is an estimate.
  [[nodiscard]] bool estimated() const { return image_.noise.estimated() || reference_.noise.estimated(); }

  /// The sums over the values of one channel in a region.
  class Region {
   public:
    void add(const NoiseModel& model, std::size_t i);
    [[nodiscard]] std::uint64_t values() const { return values_; }
    [[nodiscard]] double difference() const { return image_.sum.value() - reference_.sum.value(); }
    [[nodiscard]] double truth() const { return reference_.sum.value(); }
    /// Of the sum of differences.
    [[nodiscard]] double variance(const NoiseModel& model) const;
    [[nodiscard]] double z(const NoiseModel& model) const;
    /// The smallest difference d of the sums with d / sqrt(variance) = z, which grows with d.
    [[nodiscard]] double visible_difference(const NoiseModel& model, double z) const;

   private:
    struct Sums {
      CompensatedSum sum, variance;
      CompensatedSum from_other;  ///< the variance that the other image's samples give
      CompensatedSum samples;
    };
    [[nodiscard]] double base_variance() const;
    /// F / n of light that the image lacks.
    [[nodiscard]] double missing_light(const NoiseModel& model, bool of_image) const;

    Sums image_, reference_;
    CompensatedSum rounding_;
    std::uint64_t values_ = 0;
    std::size_t channel_ = 0;
  };

 private:
  struct Side {
    ImageNoise noise;
    std::vector<double> portion;  ///< F of each channel; 0 if variances are exact
  };

  [[nodiscard]] std::size_t block_of(std::size_t pixel) const;
  void add_blocks(const ImageNoise& noise);
  [[nodiscard]] std::vector<double> portions(const ImageNoise& noise, bool of_image) const;
  /// The variance of value i of one side, as far as it does not depend on the difference.
  [[nodiscard]] double variance_of(const Side& side, const Side& other, std::size_t i) const;

  const ImagePair& pair_;
  int block_;
  std::size_t blocks_across_ = 0;
  Side image_, reference_;
  std::vector<double> block_variance_;  ///< per sample; of each block and channel, the larger of both images
  std::vector<std::uint8_t> block_known_;
};

}  // namespace penumbra
