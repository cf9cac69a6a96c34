#include "scheduler/film_accumulator.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra {
namespace {

// hash() reads the pixels as bytes, so they must not hold any padding.
static_assert(sizeof(PixelStatistics) == 14 * 8);

/// Share of the new samples in the merged mean, and the weight of the squared difference of the means in the
/// merged sum of squares: n_b / n and n_a n_b / n.
struct MergeWeights {
  double share;
  double squares;
};

MergeWeights merge_weights(std::uint64_t count_a, std::uint64_t count_b) {
  const double share = double(count_b) / double(count_a + count_b);
  return {share, double(count_a) * share};
}

// T. F. Chan, G. H. Golub, R. J. LeVeque, "Updating formulae and a pairwise algorithm for computing sample
// variances" (1979), eq. 2.1: mean and sum of squared deviations of the union of two sets of samples.
void merge_radiance(PixelStatistics& pixel, int channel, double mean, double m2, MergeWeights weights) {
  const double difference = mean - pixel.mean[channel];
  pixel.mean[channel] += difference * weights.share;
  pixel.m2[channel] += m2 + difference * difference * weights.squares;
}

void merge_mean(double& merged, double mean, MergeWeights weights) {
  merged += (mean - merged) * weights.share;
}

}  // namespace

FilmAccumulator::FilmAccumulator(int x, int y, int width, int height, bool has_features)
    : x_(x),
      y_(y),
      width_(width),
      height_(height),
      has_features_(has_features),
      pixels_(std::size_t(width) * std::size_t(height)) {}

void FilmAccumulator::add(int x, int y, const SampleBuffer& result) {
  const std::size_t plane = result.pixels();
  const bool features = has_features_ && result.planes == kSampleBufferPlanes;
  for (int row = 0; row < result.height; ++row) {
    PixelStatistics* pixel = &pixels_[std::size_t(y - y_ + row) * std::size_t(width_) + std::size_t(x - x_)];
    const float* value = result.values.data() + std::size_t(row) * std::size_t(result.width);
    for (int column = 0; column < result.width; ++column, ++pixel, ++value) {
      const MergeWeights weights = merge_weights(pixel->count, result.sample_count);
      for (int c = 0; c < 3; ++c) {
        merge_radiance(*pixel, c, value[(kMeanR + c) * plane], value[(kM2R + c) * plane], weights);
      }
      if (features) {
        for (int c = 0; c < 3; ++c) {
          merge_mean(pixel->albedo[c], value[(kAlbedoR + c) * plane], weights);
          merge_mean(pixel->normal[c], value[(kNormalX + c) * plane], weights);
        }
        merge_mean(pixel->depth, value[kDepth * plane], weights);
      }
      pixel->count += result.sample_count;
    }
  }
  nan_samples_ += result.nan_samples;
  infinite_samples_ += result.infinite_samples;
}

void FilmAccumulator::clear(int x, int y, int width, int height, std::uint64_t nan_samples,
                            std::uint64_t infinite_samples) {
  for (int row = 0; row < height; ++row) {
    const auto first = pixels_.begin() + (std::ptrdiff_t(y - y_ + row) * width_ + (x - x_));
    std::fill_n(first, width, PixelStatistics{});
  }
  nan_samples_ -= nan_samples;
  infinite_samples_ -= infinite_samples;
}

const PixelStatistics& FilmAccumulator::at(int film_x, int film_y) const {
  return pixels_[std::size_t(film_y - y_) * std::size_t(width_) + std::size_t(film_x - x_)];
}

double FilmAccumulator::relative_error() const {
  double sum = 0;
  std::uint64_t channels = 0;
  for (const PixelStatistics& pixel : pixels_) {
    if (pixel.count < 2) continue;
    const double per_m2 = 1.0 / (double(pixel.count) * double(pixel.count - 1));
    for (int c = 0; c < 3; ++c) {
      sum += pixel.m2[c] * per_m2 / (pixel.mean[c] * pixel.mean[c] + 0.01);
    }
    channels += 3;
  }
  return channels == 0 ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(sum / double(channels));
}

std::uint64_t FilmAccumulator::hash() const {
  return XXH3_64bits(pixels_.data(), pixels_.size() * sizeof(PixelStatistics));
}

}  // namespace penumbra
