// Follows the points that pixels show from frame to frame, along the layer `motion`.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "scheduler/denoise/denoise.h"
#include "scheduler/image/image.h"

namespace penumbra {

/// In pixels; the middle of the first pixel is (0, 0).
struct PointPosition {
  float x = 0, y = 0;
};

/// What is known of the points that a frame shows.
struct SeenPoints {
  Planes
      motion;  ///< 4 planes: x and y of the way to where the frame before shows the point, and the next one
  Planes normal, depth;  ///< 3 and 1 planes; 0 where the image has none
};

/// Whether the image has the layer `motion`.
bool has_motion(const Image& image);
SeenPoints seen_points(const Image& image);

enum class TimeDirection { kBefore, kAfter };

/// Where the points of a frame are in those before it, or after it.
class PointTracker {
 public:
  /// `first`, which must stay valid: the frame whose points are followed.
  PointTracker(const SeenPoints& first, TimeDirection direction);

  /// Goes on from one frame to the one beside it, of the same size. A point is lost where it leaves the
  /// image, where its way back does not end within a pixel, and where depth or normal are those of another
  /// point.
  void follow(const SeenPoints& from, const SeenPoints& to);

  /// For each pixel of the first frame; nothing where its point is lost.
  [[nodiscard]] const std::vector<std::optional<PointPosition>>& positions() const { return positions_; }

 private:
  const SeenPoints& first_;
  int out_, back_;  // the first planes of `motion` that lead on, and back
  std::vector<std::optional<PointPosition>> positions_;
};

/// Pixels and their weights, of sum 1, for interpolation.
struct Taps {
  std::array<std::size_t, 4> pixels = {};
  std::array<float, 4> weights = {};

  [[nodiscard]] float mean(const Planes& image, int plane) const;
  /// Of the mean of pixels of these variances.
  [[nodiscard]] float variance(const Planes& variances, int plane) const;
};
/// Bilinear interpolation among the pixels that may show the same point as a pixel of `first`; nothing if
/// none does.
std::optional<Taps> alike_taps(const SeenPoints& first, std::size_t pixel, const SeenPoints& image,
                               PointPosition at);

/// Bilinear; outside of the image as at its edge.
float value_at(const Planes& image, int plane, PointPosition at);

}  // namespace penumbra
