// The merged image: per-pixel statistics in double, fed with work-unit results in pass order.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "kernels/host/error.h"
#include "kernels/host/sample_buffer.h"
#include "scheduler/plan/byte_stream.h"
#include "scheduler/plan/film_mattes.h"

namespace penumbra {

/// Running statistics of one pixel's radiance per channel; `m2` is the sum of squared deviations.
struct PixelStatistics {
  std::uint64_t count = 0;
  double mean[3] = {0, 0, 0};
  double m2[3] = {0, 0, 0};
};

/// A rectangle of the film. Chan's merge is not associative in floating point, so the caller adds the passes
/// of a pixel in pass order; then the result is the same bytes whatever the workers, the tiles and the
/// arrival order.
class FilmAccumulator {
 public:
  FilmAccumulator() = default;
  /// The rectangle [x, x+width) x [y, y+height) of the film, fed with results that have these layers.
  FilmAccumulator(int x, int y, int width, int height, const FilmLayers& layers);

  /// One of another rectangle without samples, whose pixels have the same layers.
  [[nodiscard]] FilmAccumulator empty_like(int x, int y, int width, int height) const {
    return {x, y, width, height, layers_};
  }

  /// Of the memory that one with these layers takes, but for mattes.
  static constexpr std::uint64_t bytes_per_pixel(const FilmLayers& layers) {
    return sizeof(PixelStatistics) + std::uint64_t(layers.planes() - kRadiancePlanes) * sizeof(double);
  }

  /// Merges a unit's result whose corner is film pixel (x, y), inside the rectangle.
  void add(int x, int y, const SampleBuffer& result);
  /// Forgets all samples of a rectangle whose corner is film pixel (x, y), results wholly inside or outside
  /// of it: for results that turned out to be unreliable and are rendered again.
  void clear(int x, int y, int width, int height);

  /// Puts into its rectangle the mean of two independent estimates of it, equally weighed whatever their
  /// samples; of one alone, where the other one has none. Of the same planes. The
  /// statistics are then those of as many samples whose mean has that mean's variance.
  void set_mean_of(const FilmAccumulator& a, const FilmAccumulator& b);

  [[nodiscard]] int x() const { return x_; }
  [[nodiscard]] int y() const { return y_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] const FilmLayers& layers() const { return layers_; }
  /// Pixel at film coordinates.
  [[nodiscard]] const PixelStatistics& at(int film_x, int film_y) const;
  /// Mean of a plane of a layer that it has, LAYER_… of kernels/film_layers.h, at film coordinates.
  [[nodiscard]] double layer(int film_x, int film_y, int layer, int plane = 0) const;
  /// The mattes that its samples hit, in the order of their numbers; none of a film without mattes.
  [[nodiscard]] std::span<const MatteWeight> mattes(int film_x, int film_y) const {
    return mattes_.is_kept() ? mattes_.at(index(film_x, film_y)) : std::span<const MatteWeight>();
  }
  /// The visible share of the polygon lights, by their samples, at film coordinates; 0 where there is no
  /// light.
  [[nodiscard]] double visibility(int film_x, int film_y) const;
  /// Samples that are not as they should be.
  [[nodiscard]] FlaggedByKind flagged() const;
  /// Relative standard error of the image: sqrt(mean over pixels and channels of SE^2 / (mean^2 + .01)), with
  /// SE^2 = m2 / (n (n - 1)) the variance of a pixel's mean, over the pixels with two samples or more; NaN
  /// while there are none.
  [[nodiscard]] double relative_error() const;
  /// XXH3-64 of all pixel statistics, layers and mattes, for tests of reproducibility and for statistics.
  [[nodiscard]] std::uint64_t hash() const;

  /// All of its state, to go on with it in another process; so many bytes, about, and at most.
  void write(ByteWriter& bytes) const;
  [[nodiscard]] std::uint64_t written_size() const { return written_with(FilmMattes::kBytesPerPixel); }
  [[nodiscard]] std::uint64_t most_written() const { return written_with(FilmMattes::kMostBytesPerPixel); }
  /// Takes the state of one of the same rectangle and planes. Error: that is not what the bytes are. It is
  /// to be thrown away then.
  Expected<void> read(ByteReader& bytes);

 private:
  [[nodiscard]] Expected<void> check() const;
  [[nodiscard]] std::uint64_t written_with(std::uint64_t matte_bytes) const {
    return (bytes_per_pixel(layers_) + (mattes_.is_kept() ? matte_bytes : 0)) * pixels_.size();
  }
  [[nodiscard]] std::size_t index(int film_x, int film_y) const {
    return std::size_t(film_y - y_) * std::size_t(width_) + std::size_t(film_x - x_);
  }
  [[nodiscard]] std::size_t layer_planes() const { return std::size_t(layers_.planes() - kRadiancePlanes); }

  int x_ = 0, y_ = 0, width_ = 0, height_ = 0;
  FilmLayers layers_;
  std::vector<PixelStatistics> pixels_;
  std::vector<double> layer_means_;  // of the layers' planes, of one pixel after the other
  FilmMattes mattes_;
  std::map<std::pair<int, int>, FlaggedByKind> flagged_;  // by the corner of the results that hold some
};

}  // namespace penumbra
