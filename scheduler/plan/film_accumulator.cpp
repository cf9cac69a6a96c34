#include "scheduler/plan/film_accumulator.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace penumbra {
namespace {

// hash() reads the pixels as bytes, so they must not hold any padding.
static_assert(sizeof(PixelStatistics) == 7 * 8);

/// Weights for merging two sets of samples: n_b / n for the mean, and n_a n_b / n for the squared difference
/// of the means in the sum of squares.
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
void merge_statistics(double& merged, double& merged_m2, double mean, double m2, MergeWeights weights) {
  const double difference = mean - merged;
  merged += difference * weights.share;
  merged_m2 += m2 + difference * difference * weights.squares;
}

void merge_mean(double& merged, double mean, MergeWeights weights) {
  merged += (mean - merged) * weights.share;
}

constexpr int kLongestRun = 64;

/// Pixels of a film beside each other.
struct FilmRun {
  PixelStatistics* pixels;
  double* layers;              // of the first pixel; null: none are merged
  std::size_t layer_count;     // of each pixel
  std::size_t with_variances;  // so many layers come first, then the planes of their variances
  std::optional<std::size_t> shape;
  int count;
};

/// Merges a run plane by plane. The planes of a tile are a power of two apart in memory, so reading all of
/// them for each pixel would push each other out of the cache. `from`: the first value of each plane.
void merge_run(const FilmRun& run, const SampleBuffer& result, std::size_t from) {
  const auto values = [&](std::size_t plane) {
    return result.values.data() + plane * result.pixels() + from;
  };
  MergeWeights weights[kLongestRun];
  for (int i = 0; i < run.count; ++i) weights[i] = merge_weights(run.pixels[i].count, result.sample_count);
  const auto merge_with_deviation = [&](double* merged, double* merged_m2, std::size_t stride,
                                        const float* means, const float* deviations) {
    for (int i = 0; i < run.count; ++i, merged += stride, merged_m2 += stride) {
      const double deviation = deviations[i];
      merge_statistics(*merged, *merged_m2, means[i], deviation * deviation * result.sample_count,
                       weights[i]);
    }
  };
  for (std::size_t c = 0; c < 3; ++c)
    merge_with_deviation(&run.pixels->mean[c], &run.pixels->m2[c], sizeof(PixelStatistics) / sizeof(double),
                         values(kMeanR + c), values(kDeviationR + c));
  if (run.layers != nullptr) {
    for (std::size_t k = 0; k < run.with_variances; ++k)
      merge_with_deviation(run.layers + k, run.layers + FEATURE_PLANES + k, run.layer_count,
                           values(kRadiancePlanes + k), values(kRadiancePlanes + FEATURE_PLANES + k));
    for (std::size_t k = 2 * run.with_variances; k < run.layer_count; ++k) {
      const float* const means = values(kRadiancePlanes + k);
      double* layer = run.layers + k;
      for (int i = 0; i < run.count; ++i, layer += run.layer_count)
        if (run.shape != k || run.pixels[i].count == 0) merge_mean(*layer, means[i], weights[i]);
    }
  }
  for (int i = 0; i < run.count; ++i) run.pixels[i].count += result.sample_count;
}

}  // namespace

FilmAccumulator::FilmAccumulator(int x, int y, int width, int height, const FilmLayers& layers)
    : x_(x),
      y_(y),
      width_(width),
      height_(height),
      layers_(layers),
      pixels_(std::size_t(width) * std::size_t(height)),
      layer_means_(pixels_.size() * layer_planes()),
      mattes_(pixels_.size(), layers.mattes()) {}

void FilmAccumulator::add(int x, int y, const SampleBuffer& result) {
  const std::size_t layer_count = layer_planes();
  const bool complete = result.planes == layers_.planes() && layer_count > 0;
  const std::size_t with_variances = layers_.has(LAYER_ALBEDO_VARIANCE) ? FEATURE_PLANES : 0;
  std::span<const std::uint32_t> mattes = result.mattes;
  for (int row = 0; row < result.height; ++row) {
    if (mattes_.is_kept() && !mattes.empty())
      mattes = mattes_.add(index(x, y + row), std::size_t(result.width), mattes);
    for (int column = 0; column < result.width; column += kLongestRun) {
      const std::size_t first = index(x + column, y + row);
      merge_run({.pixels = &pixels_[first],
                 .layers = complete ? &layer_means_[first * layer_count] : nullptr,
                 .layer_count = layer_count,
                 .with_variances = with_variances,
                 .shape = shape_plane(),
                 .count = std::min(result.width - column, kLongestRun)},
                result, std::size_t(row) * std::size_t(result.width) + std::size_t(column));
    }
  }
  if (std::ranges::any_of(result.flagged, [](const FlaggedSamples& kind) { return kind.count > 0; }))
    penumbra::add(flagged_[{x, y}], result.flagged);
}

void FilmAccumulator::clear(int x, int y, int width, int height) {
  for (int row = 0; row < height; ++row) {
    const std::size_t first = index(x, y + row);
    std::fill_n(pixels_.begin() + std::ptrdiff_t(first), width, PixelStatistics{});
    std::fill_n(layer_means_.begin() + std::ptrdiff_t(first * layer_planes()),
                std::size_t(width) * layer_planes(), 0.0);
    mattes_.clear(first, std::size_t(width));
  }
  std::erase_if(flagged_, [&](const auto& noted) {
    const auto [corner_x, corner_y] = noted.first;
    return corner_x >= x && corner_x < x + width && corner_y >= y && corner_y < y + height;
  });
}

void FilmAccumulator::set_mean_of(const FilmAccumulator& a, const FilmAccumulator& b) {
  clear(a.x_, a.y_, a.width_, a.height_);
  const std::size_t planes = layer_planes();
  const auto variance = [](std::uint64_t count, double m2) {
    return count < 2 ? 0 : m2 / (double(count) * double(count - 1));
  };
  const auto is_variance = [&](std::size_t plane) {
    return layers_.has(LAYER_ALBEDO_VARIANCE) && plane >= FEATURE_PLANES && plane < 2 * FEATURE_PLANES;
  };
  const std::optional<std::size_t> shape = shape_plane();
  for (int y = a.y_; y < a.y_ + a.height_; ++y) {
    for (int x = a.x_; x < a.x_ + a.width_; ++x) {
      const PixelStatistics &of_a = a.at(x, y), &of_b = b.at(x, y);
      const double weight = of_b.count == 0 ? 1 : of_a.count == 0 ? 0 : 0.5;  // weight of a
      PixelStatistics& mean = pixels_[index(x, y)];
      mean.count = of_a.count + of_b.count;
      const double n = double(mean.count);
      const auto mean_m2 = [&](double m2_a, double m2_b) {
        return (weight * weight * variance(of_a.count, m2_a) +
                (1 - weight) * (1 - weight) * variance(of_b.count, m2_b)) *
               n * std::max(n - 1, 0.0);
      };
      for (int c = 0; c < 3; ++c) {
        mean.mean[c] = weight * of_a.mean[c] + (1 - weight) * of_b.mean[c];
        mean.m2[c] = mean_m2(of_a.m2[c], of_b.m2[c]);
      }
      const double *layer_a = a.layer_means_.data() + a.index(x, y) * planes,
                   *layer_b = b.layer_means_.data() + b.index(x, y) * planes;
      double* layer = layer_means_.data() + index(x, y) * planes;
      for (std::size_t k = 0; k < planes; ++k)
        layer[k] = is_variance(k) ? mean_m2(layer_a[k], layer_b[k])
                                  : weight * layer_a[k] + (1 - weight) * layer_b[k];
      if (shape) layer[*shape] = of_a.count > 0 ? layer_a[*shape] : layer_b[*shape];
      const auto scale = [n](double share, const PixelStatistics& of) {
        return of.count == 0 ? 0 : share * (n / double(of.count));
      };
      if (mattes_.is_kept())
        mattes_.set_sum_of(index(x, y), a.mattes(x, y), scale(weight, of_a), b.mattes(x, y),
                           scale(1 - weight, of_b));
    }
  }
  for (const FilmAccumulator* half : {&a, &b})
    for (const auto& [corner, noted] : half->flagged_) penumbra::add(flagged_[corner], noted);
}

double FilmAccumulator::visibility(int film_x, int film_y) const {
  const double unshadowed = layer(film_x, film_y, LAYER_UNSHADOWED);
  return unshadowed > 0 ? layer(film_x, film_y, LAYER_SHADOWED) / unshadowed : 0;
}

FlaggedByKind FilmAccumulator::flagged() const {
  FlaggedByKind all;
  for (const auto& [corner, noted] : flagged_) penumbra::add(all, noted);
  return all;
}

const PixelStatistics& FilmAccumulator::at(int film_x, int film_y) const {
  return pixels_[index(film_x, film_y)];
}

double FilmAccumulator::layer(int film_x, int film_y, int layer, int plane) const {
  const auto place = std::size_t(layers_.plane(layer) - kRadiancePlanes + plane);
  return layer_means_[index(film_x, film_y) * layer_planes() + place];
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

void FilmAccumulator::write(ByteWriter& bytes) const {
  for (const int number : {x_, y_, width_, height_, layers_.planes()}) bytes.i64(number);
  bytes.row(pixels_);
  bytes.row(layer_means_);
  mattes_.write(bytes);
  bytes.u64(flagged_.size());
  for (const auto& [corner, noted] : flagged_) {
    bytes.i64(corner.first);
    bytes.i64(corner.second);
    for (const FlaggedSamples& samples : noted) {
      bytes.u64(samples.count);
      for (const int number :
           {samples.x, samples.y, samples.source.where, samples.source.step, samples.shape})
        bytes.i64(number);
      bytes.u64(samples.sample);
    }
  }
}

Expected<void> FilmAccumulator::read(ByteReader& bytes) {
  for (const int number : {x_, y_, width_, height_, layers_.planes()})
    if (bytes.i64() != number) return fail("a film of another size or with other layers");
  if (!bytes.row(pixels_) || !bytes.row(layer_means_)) return fail("it is truncated in its film");
  if (auto read = mattes_.read(bytes); !read) return read;
  const std::uint64_t corners = bytes.u64();
  if (corners > pixels_.size()) return fail("more tiles with flagged samples than pixels");
  const auto number = [&](int low, int high) {
    const std::int64_t value = bytes.i64();
    return value >= low && value <= high ? std::optional(int(value)) : std::nullopt;
  };
  const auto any_number = [&] {
    return number(std::numeric_limits<int>::min(), std::numeric_limits<int>::max());
  };
  for (std::uint64_t i = 0; i < corners; ++i) {
    const auto x = number(x_, x_ + width_ - 1), y = number(y_, y_ + height_ - 1);
    if (!x || !y) return fail("flagged samples outside the film");
    for (FlaggedSamples& samples : flagged_[{*x, *y}]) {
      samples.count = bytes.u64();
      const auto at_x = number(0, x_ + width_ - 1), at_y = number(0, y_ + height_ - 1);
      const auto where = any_number(), step = any_number(), shape = any_number();
      const std::uint64_t sample = bytes.u64();
      if (!at_x || !at_y || !where || !step || !shape || sample > std::numeric_limits<std::uint32_t>::max())
        return fail("a flagged sample that cannot be");
      samples.x = *at_x, samples.y = *at_y;
      samples.source = {*where, *step};
      samples.shape = *shape;
      samples.sample = std::uint32_t(sample);
      if (!is_possible(samples)) return fail("a flagged sample that cannot be");
    }
  }
  return bytes.failed() ? fail("it is truncated in its film") : check();
}

/// Checks that the numbers can be statistics.
Expected<void> FilmAccumulator::check() const {
  const auto is_finite = [](double value) { return std::isfinite(value); };
  for (const PixelStatistics& pixel : pixels_)
    if (!std::ranges::all_of(pixel.mean, is_finite) ||
        !std::ranges::all_of(pixel.m2, [](double m2) { return std::isfinite(m2) && m2 >= 0; }))
      return fail("a pixel with invalid statistics");
  if (!std::ranges::all_of(layer_means_, is_finite)) return fail("a layer with a value that is not finite");
  for (std::size_t i = 0; mattes_.is_kept() && i < pixels_.size(); ++i)
    if (!mattes_.are_of(i, pixels_[i].count)) return fail("a pixel with mattes of more than its samples");
  return {};
}

std::uint64_t FilmAccumulator::hash() const {
  const std::uint64_t of_radiance = XXH3_64bits(pixels_.data(), pixels_.size() * sizeof(PixelStatistics));
  return mattes_.hash(
      XXH3_64bits_withSeed(layer_means_.data(), layer_means_.size() * sizeof(double), of_radiance));
}

}  // namespace penumbra
