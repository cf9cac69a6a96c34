// The merged image: per-pixel statistics in double precision. Results of work units are added in pass order.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "kernels/host/error.h"
#include "kernels/host/sample_buffer.h"
#include "scheduler/plan/byte_stream.h"
#include "scheduler/plan/film_mattes.h"

namespace penumbra {

/// Running statistics of a pixel's radiance, per channel. `m2` is the sum of squared deviations from the
/// mean.
struct PixelStatistics {
  std::uint64_t count = 0;
  double mean[3] = {0, 0, 0};
  double m2[3] = {0, 0, 0};
};

/// A rectangle of the film. Chan's merge of variances is not associative in floating point. So the caller
/// must add the passes of a pixel in pass order; then the result is bitwise the same for any workers, tiles
/// and order of arrival.
class FilmAccumulator {
 public:
  FilmAccumulator() = default;
  /// A film of the rectangle [x, x+width) x [y, y+height), to which results with these layers are added.
  FilmAccumulator(int x, int y, int width, int height, const FilmLayers& layers);

  /// A film without samples for another rectangle, with the same layers.
  [[nodiscard]] FilmAccumulator empty_like(int x, int y, int width, int height) const {
    return {x, y, width, height, layers_};
  }

  /// Bytes of memory per pixel with these layers, without mattes.
  static constexpr std::uint64_t bytes_per_pixel(const FilmLayers& layers) {
    return sizeof(PixelStatistics) + std::uint64_t(layers.planes() - kRadiancePlanes) * sizeof(double);
  }

  /// Adds a unit's result. Its corner is film pixel (x, y), and it lies inside the rectangle.
  void add(int x, int y, const SampleBuffer& result);
  /// Removes all samples of a rectangle whose corner is film pixel (x, y). Every result must lie wholly
  /// inside or outside of it. It is used when results turned out to be unreliable and are rendered again.
  void clear(int x, int y, int width, int height);

  /// Sets the rectangle to the mean of two independent estimates of it, with equal weights whatever their
  /// numbers of samples. If one has no samples, the other is used alone. Both must have the same planes. The
  /// resulting statistics are those of as many samples whose mean has the variance of this mean. Shapes are
  /// those of `a` where it has samples.
  void set_mean_of(const FilmAccumulator& a, const FilmAccumulator& b);

  [[nodiscard]] int x() const { return x_; }
  [[nodiscard]] int y() const { return y_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] const FilmLayers& layers() const { return layers_; }
  /// The pixel at film coordinates.
  [[nodiscard]] const PixelStatistics& at(int film_x, int film_y) const;
  /// The mean of a plane of an existing layer (LAYER_… of kernels/film_layers.h) at film coordinates; of a
  /// variance the sum of squared deviations.
  [[nodiscard]] double layer(int film_x, int film_y, int layer, int plane = 0) const;
  /// The mattes hit by the pixel's samples, by ascending ID. Empty for a film without mattes.
  [[nodiscard]] std::span<const MatteWeight> mattes(int film_x, int film_y) const {
    return mattes_.is_kept() ? mattes_.at(index(film_x, film_y)) : std::span<const MatteWeight>();
  }
  /// The visible fraction of the polygon lights, estimated from the samples, at film coordinates; 0 if there
  /// is no light.
  [[nodiscard]] double visibility(int film_x, int film_y) const;
  /// Counts of invalid samples, by kind.
  [[nodiscard]] FlaggedByKind flagged() const;
  /// The relative standard error of the image: sqrt(mean over pixels and channels of SE^2 / (mean^2 + .01)),
  /// where SE^2 = m2 / (n (n - 1)) is the variance of the mean of a pixel. It is taken over the pixels with
  /// at least two samples; NaN if there are none.
  [[nodiscard]] double relative_error() const;
  /// XXH3-64 of all pixel statistics, layers and mattes, for tests of reproducibility and for statistics.
  [[nodiscard]] std::uint64_t hash() const;

  /// Writes the whole state, so that another process can resume. The sizes are the approximate and the
  /// largest number of bytes.
  void write(ByteWriter& bytes) const;
  [[nodiscard]] std::uint64_t written_size() const { return written_with(FilmMattes::kBytesPerPixel); }
  [[nodiscard]] std::uint64_t most_written() const { return written_with(FilmMattes::kMostBytesPerPixel); }
  /// Reads the state of a film with the same rectangle and planes. Error: the bytes are not such a state; the
  /// film must then be discarded.
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
  /// Among the planes of the layers, that of LAYER_SHAPE, which is no mean: the first result remains.
  [[nodiscard]] std::optional<std::size_t> shape_plane() const {
    if (!layers_.has(LAYER_SHAPE)) return std::nullopt;
    return std::size_t(layers_.plane(LAYER_SHAPE) - kRadiancePlanes);
  }

  int x_ = 0, y_ = 0, width_ = 0, height_ = 0;
  FilmLayers layers_;
  std::vector<PixelStatistics> pixels_;
  // Pixel by pixel the planes of the layers: means, or sums of squared deviations (…_VARIANCE).
  std::vector<double> layer_means_;
  FilmMattes mattes_;
  // Keyed by the corner of the results that contain invalid samples.
  std::map<std::pair<int, int>, FlaggedByKind> flagged_;
};

}  // namespace penumbra
