// Merges images of the same render with other seeds: the statistics of all their samples together.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"
#include "scheduler/record/merge_source.h"

namespace penumbra {

/// How many of a pixel's first `samples` are in half A; see half_of_sample in kernels/block. So many samples
/// share a photon map: 1 without maps.
double samples_of_half_a(std::uint64_t samples, std::uint32_t samples_per_map);

/// Adds images one after the other, in double precision. With n samples of mean m and variance of the mean v
/// in each pixel of an image:
///   samples    the sum of n
///   means      weighted by n; `visibility`, a quotient, too, though the quotient of sums would weigh by
///   light variances  M2 / (N (N - 1)) with N the sum of n, where M2 = v n (n - 1) of each image plus the
///   squares of
///              the differences of their means: Chan, Golub, LeVeque (1979), eq. 2.1, as in FilmAccumulator
///   halves     weighted by the number of samples in the half
///   Cryptomatte  coverage weighted by n; the six largest IDs
/// With --target-error the number of samples depends on their values, and weights by n would be biased. Then
/// every image has the weight w of its samples as asked for, and variances are those of that mean, the sum of
/// w² v / (sum of w)². Pixels without samples count nowhere.
class ImageMerge {
 public:
  /// Checked sources. Channels that not all of them have, or that cannot be merged, are left out.
  explicit ImageMerge(const std::vector<MergeSource>& sources);

  /// Adds the image of `source`, read again. The result depends on the order in its last bits. Errors: its
  /// size or channels are not those of the source; values that no render has, with their number and the
  /// first: NaN, infinite, a negative variance or number of samples.
  Expected<void> add(const MergeSource& source, const Image& image);

  /// The merged image with all metadata. Error: values beyond the range of a file's floats, such as the
  /// variance of 0 and 1e38.
  [[nodiscard]] Expected<Image> image() const;
  /// What is left out or approximate, for users.
  [[nodiscard]] std::vector<std::string> remarks() const;

 private:
  enum class Kind { kMean, kFirst, kVariance, kSamples, kHalfA, kHalfB, kMatte };
  struct Channel {
    std::string name;
    Kind kind;
    std::size_t mean = 0;  // kVariance: the index of its mean
  };
  struct Pixel {
    double samples = 0, weight = 0, half_a = 0, half_b = 0;  // the last three are sums of weights
  };
  using Coverage = std::map<std::uint32_t, double>;  // sums of weight times coverage, by ID

  void choose_channels();
  /// `from`: the indices of the merged channels in the image.
  [[nodiscard]] Expected<void> check_values(const std::string& name, const Image& image,
                                            std::span<const std::size_t> from) const;
  void add_pixel(std::size_t at, std::span<const float> values, double weight, double share_of_a);
  void add_mattes(std::size_t at, std::span<const float> values, double weight);
  void append_mattes(std::size_t at, std::vector<float>& values) const;
  [[nodiscard]] float value_of(std::size_t at, std::size_t channel) const;

  const std::vector<MergeSource>& sources_;
  bool by_samples_;                // false: weights as asked for
  std::vector<Channel> channels_;  // mattes are the last
  std::size_t mattes_ = 0;         // number of those
  std::vector<std::string> left_out_;
  std::vector<double> values_;  // by pixel: means and variances; of variances M2, or the sum of w² v
  std::vector<Pixel> pixels_;
  std::vector<Coverage> coverage_;  // by pixel and layer
  std::uint64_t full_pixels_ = 0;   // whose Cryptomatte may have had more IDs than a file holds
};

}  // namespace penumbra
