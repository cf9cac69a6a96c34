#include "scheduler/denoise/in_time.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "kernels/math/math.h"
#include "scheduler/denoise/denoise_image.h"
#include "scheduler/denoise/guide.h"
#include "scheduler/denoise/layers.h"

namespace penumbra {
namespace {

constexpr int kPatchRadius = 3;
// The difference in standard deviations that still counts as noise. Remaining noise is correlated over some
// pixels, so patches average it less than the noise of images, and more has to pass than in non-local means.
constexpr double kStrength = 1;
constexpr float kLeastAlbedo = 0.05f;     // light is divided by no less
constexpr float kLeastNoise = 1e-3f;      // of light, relative: remaining noise is known no better
constexpr float kMostWay = 1;             // pixels that a point may be off when it is followed there and back
constexpr float kMostTurn = 0.9f;         // least cosine between normals of one point
constexpr float kMostDepthChange = 0.1f;  // of depths of one point, relative

/// A denoised frame as planes.
struct DenoisedFrame {
  Planes light;  ///< 3: the frame's own radiance over albedo
  Planes noise;  ///< 3: its remaining variance over squared albedo, the mean of patches
  Planes albedo, motion, normal,
      depth;  ///< albedo at least kLeastAlbedo; normal, depth 0 where there are none
};

struct ChannelsInTime {
  std::vector<std::size_t> color, error, motion, albedo, normal, depth;
};

ChannelsInTime channels_of(const Image& image) {
  const bool is_blended = image.channel("still.R").has_value();
  ChannelsInTime channels{.color = find_layer(image, {"still"}, {"RGB"}),
                          .error = find_layer(image, {is_blended ? "still_error" : "error"}, {"RGB"}),
                          .motion = find_layer(image, {"motion"}, {"XYZW"}),
                          .albedo = find_layer(image, {"albedo"}, {"RGB"}),
                          .normal = find_layer(image, {"normal"}, {"XYZ"}),
                          .depth = find_layer(image, {"depth"}, {"Z"})};
  if (const auto rgb = image.beauty_channels(); rgb && !is_blended)
    channels.color.assign(rgb->begin(), rgb->end());
  return channels;
}

DenoisedFrame frame_of(const Image& image) {
  const ChannelsInTime channels = channels_of(image);
  const auto planes = [&](const std::vector<std::size_t>& layer, int count) {
    return layer.empty() ? Planes(image.data.width, image.data.height, count) : planes_of(image, layer);
  };
  DenoisedFrame frame{.light = planes(channels.color, 3),
                      .noise = planes(channels.error, 3),
                      .albedo = planes(channels.albedo, 3),
                      .motion = planes(channels.motion, 4),
                      .normal = planes(channels.normal, 3),
                      .depth = planes(channels.depth, 1)};
  for (std::size_t i = 0; i < frame.light.values.size(); ++i) {
    float& albedo = frame.albedo.values[i];
    albedo = albedo > kLeastAlbedo ? albedo : channels.albedo.empty() ? 1 : kLeastAlbedo;
    frame.light.values[i] /= albedo;
    frame.noise.values[i] /= albedo * albedo;
  }
  frame.noise = box_mean(frame.noise, kPatchRadius);
  for (std::size_t i = 0; i < frame.light.values.size(); ++i)
    frame.noise.values[i] += sqr(kLeastNoise * frame.light.values[i]);
  return frame;
}

struct Position {
  float x = 0, y = 0;
};

/// The pixel that holds a position; nothing outside of the image.
std::optional<std::size_t> pixel_at(const Planes& image, Position at) {
  // Also false for NaN.
  if (!(at.x > -0.5f && at.y > -0.5f && at.x < float(image.width) - 0.5f &&
        at.y < float(image.height) - 0.5f))
    return std::nullopt;
  return std::size_t(at.y + 0.5f) * std::size_t(image.width) + std::size_t(at.x + 0.5f);
}

/// Bilinear.
float value_at(const Planes& image, int plane, Position at) {
  const float x = std::clamp(at.x, 0.0f, float(image.width - 1)),
              y = std::clamp(at.y, 0.0f, float(image.height - 1));
  const auto left = std::size_t(x), upper = std::size_t(y), width = std::size_t(image.width);
  const std::size_t right = std::min(left + 1, width - 1),
                    lower = std::min(upper + 1, std::size_t(image.height) - 1);
  const std::span<const float> values = image.plane(plane);
  const float u = x - float(left), v = y - float(upper);
  const float above = values[upper * width + left] * (1 - u) + values[upper * width + right] * u;
  const float below = values[lower * width + left] * (1 - u) + values[lower * width + right] * u;
  return above * (1 - v) + below * v;
}

/// Whether two pixels may show the same point.
bool is_alike(const DenoisedFrame& a, std::size_t at_a, const DenoisedFrame& b, std::size_t at_b) {
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

/// Where the points of all pixels are in the frames before, or after, one frame after the other.
class Ways {
 public:
  /// `out`: the plane of `motion` that leads on; `back`: the one that leads back.
  Ways(const DenoisedFrame& first, int out, int back) : first_(first), out_(out), back_(back) {
    for (int y = 0; y < first.light.height; ++y)
      for (int x = 0; x < first.light.width; ++x) positions_.push_back(Position{float(x), float(y)});
  }

  /// Goes on from one frame to the next.
  void follow(const DenoisedFrame& from, const DenoisedFrame& to) {
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      if (!positions_[i]) continue;
      const Position at = *positions_[i];
      positions_[i].reset();
      const std::optional<std::size_t> pixel = pixel_at(from.light, at);
      const auto step = [&](const DenoisedFrame& frame, int plane, std::size_t of) {
        return Position{frame.motion.plane(plane)[of], frame.motion.plane(plane + 1)[of]};
      };
      const Position way = step(from, out_, *pixel), reached{at.x + way.x, at.y + way.y};
      const std::optional<std::size_t> other = pixel_at(to.light, reached);
      if (!other) continue;
      const Position back = step(to, back_, *other);
      if (std::abs(way.x + back.x) <= kMostWay && std::abs(way.y + back.y) <= kMostWay &&
          is_alike(first_, i, to, *other))
        positions_[i] = reached;
    }
  }

  /// Nothing: the point is not seen there.
  [[nodiscard]] const std::vector<std::optional<Position>>& positions() const { return positions_; }

 private:
  const DenoisedFrame& first_;
  int out_, back_;
  std::vector<std::optional<Position>> positions_;
};

/// Sums over the frames of each pixel.
struct Sums {
  Planes light, noise;  ///< 3 planes each, with weights and squared weights
  Planes weights;       ///< 1 plane
};

float mean_noise(const Planes& noise, std::size_t i) {
  return (noise.plane(0)[i] + noise.plane(1)[i] + noise.plane(2)[i]) / 3;
}

/// Adds what another frame shows of the same points.
void add_frame(const DenoisedFrame& frame, const DenoisedFrame& other,
               const std::vector<std::optional<Position>>& positions, Sums& sums) {
  const int width = frame.light.width, height = frame.light.height;
  Planes light(width, height, 3), noise(width, height, 3), distances(width, height, 2);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!positions[i]) continue;
    double distance = 0;
    for (int c = 0; c < 3; ++c) {
      const float value = light.plane(c)[i] = value_at(other.light, c, *positions[i]);
      const float left = noise.plane(c)[i] = value_at(other.noise, c, *positions[i]);
      const double both = double(left) + double(frame.noise.plane(c)[i]);
      const double difference = double(value) - double(frame.light.plane(c)[i]);
      if (!(both <= 0 && difference == 0))  // 0 / 0 where nothing shines
        distance += (difference * difference - both) / (3 * kStrength * kStrength * both);
    }
    if (!std::isfinite(distance)) continue;
    distances.plane(0)[i] = float(std::min(distance, 1e6));
    distances.plane(1)[i] = 1;
  }
  const Planes means = box_mean(distances, kPatchRadius);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!(distances.plane(1)[i] > 0)) continue;
    const float similarity = exp_f(-std::max(means.plane(0)[i] / means.plane(1)[i], 0.0f));
    const float own = mean_noise(frame.noise, i), left = mean_noise(noise, i);
    const float weight = left > 0 ? similarity * (own / left) : similarity;
    if (!std::isfinite(weight)) continue;
    sums.weights.plane(0)[i] += weight;
    for (int c = 0; c < 3; ++c) {
      sums.light.plane(c)[i] += weight * light.plane(c)[i];
      sums.noise.plane(c)[i] += weight * weight * noise.plane(c)[i];
    }
  }
}

/// The frame's radiance and remaining variance as it would be written.
void write_blend(const Sums& sums, const DenoisedFrame& frame, Image& image) {
  Planes light = sums.light, noise = sums.noise;
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < light.pixels(); ++i) {
      const float scale = frame.albedo.plane(c)[i] / sums.weights.plane(0)[i];
      light.plane(c)[i] *= scale;
      noise.plane(c)[i] *= scale * scale;
    }
  const ChannelsInTime channels = channels_of(image);
  if (!image.channel("still.R")) {
    const std::string color[] = {"still.R", "still.G", "still.B"};
    const std::string error[] = {"still_error.R", "still_error.G", "still_error.B"};
    image = with_channels(image, color, planes_of(image, channels.color));
    image = with_channels(image, error, planes_of(image, channels.error));
  }
  set_channels(image, *image.beauty_channels(), light);
  set_channels(image, find_layer(image, {"error"}, {"RGB"}), noise);
}

}  // namespace

std::string lacks_for_time(const Image& denoised) {
  const ChannelsInTime channels = channels_of(denoised);
  if (channels.color.empty()) return "R, G, B";
  if (channels.motion.empty()) return "motion.X/Y/Z/W (render with --layers motion)";
  if (channels.error.empty()) return "error.R/G/B (render with --denoise=layers)";
  return "";
}

std::string hashes_of(const std::vector<const Image*>& images) {
  std::vector<std::string> hashes;
  for (const Image* image : images) {
    const std::string hash = metadata_text(*image, kFilmHash);
    hashes.push_back(hash.empty() ? "?" : hash);
  }
  return fmt::format("{}", fmt::join(hashes, " "));
}

Expected<Image> blended_in_time(const Image& frame, const FramesBeside& beside) {
  const auto check = [&](const Image& image) -> Expected<void> {
    if (const std::string lacks = lacks_for_time(image); !lacks.empty()) return fail("it lacks " + lacks);
    if (image.data != frame.data)
      return fail(fmt::format("it has {} x {} pixels, the frame beside it {} x {}", image.data.width,
                              image.data.height, frame.data.width, frame.data.height));
    return {};
  };
  if (const auto checked = check(frame); !checked) return std::unexpected(checked.error());
  const DenoisedFrame own = frame_of(frame);
  Sums sums{
      .light = own.light, .noise = own.noise, .weights = Planes(own.light.width, own.light.height, 1, 1.0f)};
  constexpr int kBefore = 0, kAfter = 2;  // planes of `motion`
  for (const auto& [images, out, back, side] :
       {std::tuple(&beside.before, kBefore, kAfter, "before"), {&beside.after, kAfter, kBefore, "after"}}) {
    Ways ways(own, out, back);
    DenoisedFrame last = own;
    for (std::size_t k = 0; k < images->size(); ++k) {
      if (const auto checked = check(*(*images)[k]); !checked)
        return fail(fmt::format("{} {}: {}", k + 1, side, checked.error().message));
      DenoisedFrame next = frame_of(*(*images)[k]);
      ways.follow(last, next);
      add_frame(own, next, ways.positions(), sums);
      last = std::move(next);
    }
  }
  Image result = frame;
  write_blend(sums, own, result);
  std::erase_if(result.metadata, [](const auto& entry) { return describes_file(entry.first); });
  for (const auto& [name, images] :
       {std::pair(kFramesBefore, &beside.before), {kFramesAfter, &beside.after}}) {
    std::erase_if(result.metadata,
                  [key = std::string_view(name)](const auto& entry) { return entry.first == key; });
    result.metadata.emplace_back(name, hashes_of(*images));
  }
  return result;
}

}  // namespace penumbra
