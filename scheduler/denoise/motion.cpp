#include "scheduler/denoise/motion.h"

#include <algorithm>
#include <cmath>

#include "scheduler/denoise/layers.h"

namespace penumbra {
namespace {

constexpr float kMostWay = 1;             // pixels that a point may be off when it is followed there and back
constexpr float kMostTurn = 0.9f;         // least cosine between normals of one point
constexpr float kMostDepthChange = 0.1f;  // of depths of one point, relative

std::vector<std::size_t> motion_channels(const Image& image) {
  return find_layer(image, {"motion"}, {"XYZW"});
}

/// The pixel that holds a position; nothing outside of the image.
std::optional<std::size_t> pixel_at(const Planes& image, PointPosition at) {
  // Also false for NaN.
  if (!(at.x > -0.5f && at.y > -0.5f && at.x < float(image.width) - 0.5f &&
        at.y < float(image.height) - 0.5f))
    return std::nullopt;
  return std::size_t(at.y + 0.5f) * std::size_t(image.width) + std::size_t(at.x + 0.5f);
}

/// Whether two pixels may show the same point.
bool is_alike(const SeenPoints& a, std::size_t at_a, const SeenPoints& b, std::size_t at_b) {
  float product = 0, square_a = 0, square_b = 0;
  for (int c = 0; c < 3; ++c) {
    const float na = a.normal.plane(c)[at_a], nb = b.normal.plane(c)[at_b];
    product += na * nb;
    square_a += na * na;
    square_b += nb * nb;
  }
  const float depth_a = a.depth.plane(0)[at_a], depth_b = b.depth.plane(0)[at_b];
  return product >= kMostTurn * std::sqrt(square_a * square_b) &&
         std::abs(depth_a - depth_b) <= kMostDepthChange * std::max(depth_a, depth_b);
}

}  // namespace

bool has_motion(const Image& image) { return !motion_channels(image).empty(); }

SeenPoints seen_points(const Image& image) {
  return {.motion = planes_of_layer(image, motion_channels(image), 4),
          .normal = planes_of_layer(image, find_layer(image, {"normal"}, {"XYZ"}), 3),
          .depth = planes_of_layer(image, find_layer(image, {"depth"}, {"Z"}), 1)};
}

PointTracker::PointTracker(const SeenPoints& first, TimeDirection direction)
    : first_(first),
      out_(direction == TimeDirection::kBefore ? 0 : 2),
      back_(direction == TimeDirection::kBefore ? 2 : 0) {
  for (int y = 0; y < first.motion.height; ++y)
    for (int x = 0; x < first.motion.width; ++x) positions_.push_back(PointPosition{float(x), float(y)});
}

void PointTracker::follow(const SeenPoints& from, const SeenPoints& to) {
  const auto step = [](const SeenPoints& frame, int plane, std::size_t pixel) {
    return PointPosition{frame.motion.plane(plane)[pixel], frame.motion.plane(plane + 1)[pixel]};
  };
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    if (!positions_[i]) continue;
    const PointPosition at = *positions_[i];
    positions_[i].reset();
    const PointPosition way = step(from, out_, *pixel_at(from.motion, at));
    const PointPosition reached{at.x + way.x, at.y + way.y};
    const std::optional<std::size_t> pixel = pixel_at(to.motion, reached);
    if (!pixel) continue;
    const PointPosition back = step(to, back_, *pixel);
    if (std::abs(way.x + back.x) <= kMostWay && std::abs(way.y + back.y) <= kMostWay &&
        is_alike(first_, i, to, *pixel))
      positions_[i] = reached;
  }
}

namespace {

/// Bilinear weights of four pixels.
Taps bilinear_taps(int width, int height, PointPosition at) {
  const float x = std::clamp(at.x, 0.0f, float(width - 1)), y = std::clamp(at.y, 0.0f, float(height - 1));
  const auto left = std::size_t(x), upper = std::size_t(y), pitch = std::size_t(width);
  const std::size_t right = std::min(left + 1, pitch - 1),
                    lower = std::min(upper + 1, std::size_t(height) - 1);
  const float u = x - float(left), v = y - float(upper);
  return {{upper * pitch + left, upper * pitch + right, lower * pitch + left, lower * pitch + right},
          {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v}};
}

}  // namespace

float Taps::mean(const Planes& image, int plane) const {
  const std::span<const float> values = image.plane(plane);
  float sum = 0;
  for (std::size_t k = 0; k < pixels.size(); ++k)
    if (weights[k] > 0) sum += weights[k] * values[pixels[k]];
  return sum;
}

float Taps::variance(const Planes& variances, int plane) const {
  const std::span<const float> values = variances.plane(plane);
  float sum = 0;
  for (std::size_t k = 0; k < pixels.size(); ++k)
    if (weights[k] > 0) sum += weights[k] * weights[k] * values[pixels[k]];
  return sum;
}

std::optional<Taps> alike_taps(const SeenPoints& first, std::size_t pixel, const SeenPoints& image,
                               PointPosition at) {
  constexpr float kLeastShare = 1e-3f;
  Taps taps = bilinear_taps(image.motion.width, image.motion.height, at);
  float sum = 0;
  for (std::size_t k = 0; k < taps.pixels.size(); ++k) {
    if (!is_alike(first, pixel, image, taps.pixels[k])) taps.weights[k] = 0;
    sum += taps.weights[k];
  }
  if (!(sum > kLeastShare)) return std::nullopt;
  for (float& weight : taps.weights) weight /= sum;
  return taps;
}

float value_at(const Planes& image, int plane, PointPosition at) {
  const Taps taps = bilinear_taps(image.width, image.height, at);
  const std::span<const float> values = image.plane(plane);
  float sum = 0;
  for (std::size_t k = 0; k < taps.pixels.size(); ++k) sum += taps.weights[k] * values[taps.pixels[k]];
  return sum;
}

}  // namespace penumbra
