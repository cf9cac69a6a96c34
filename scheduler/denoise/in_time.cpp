#include "scheduler/denoise/in_time.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <tuple>

#include "kernels/math/math.h"
#include "scheduler/denoise/denoise_image.h"
#include "scheduler/denoise/guide.h"
#include "scheduler/denoise/layers.h"
#include "scheduler/denoise/motion.h"

namespace penumbra {
namespace {

constexpr int kPatchRadius = 3;
// The difference in standard deviations that still counts as noise. Remaining noise is correlated over some
// pixels, so patches average it less than the noise of images, and more has to pass than in non-local means.
constexpr double kStrength = 1;
constexpr float kLeastAlbedo = 0.05f;  // light is divided by no less
constexpr float kLeastNoise = 1e-3f;   // of light, relative: remaining noise is known no better

/// A denoised frame as planes.
struct DenoisedFrame {
  Planes light;   ///< 3: the frame's own radiance over albedo
  Planes noise;   ///< 3: its remaining variance over squared albedo, the mean of patches
  Planes albedo;  ///< 3: at least kLeastAlbedo
  SeenPoints points;
};

struct ChannelsInTime {
  std::vector<std::size_t> color, error, albedo;
};

ChannelsInTime channels_of(const Image& image) {
  const bool is_blended = image.channel("still.R").has_value();
  ChannelsInTime channels{.color = find_layer(image, {"still"}, {"RGB"}),
                          .error = find_layer(image, {is_blended ? "still_error" : "error"}, {"RGB"}),
                          .albedo = find_layer(image, {"albedo"}, {"RGB"})};
  if (const auto rgb = image.beauty_channels(); rgb && !is_blended)
    channels.color.assign(rgb->begin(), rgb->end());
  return channels;
}

DenoisedFrame frame_of(const Image& image) {
  const ChannelsInTime channels = channels_of(image);
  DenoisedFrame frame{.light = planes_of(image, channels.color),
                      .noise = planes_of(image, channels.error),
                      .albedo = planes_of_layer(image, channels.albedo, 3),
                      .points = seen_points(image)};
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
               const std::vector<std::optional<PointPosition>>& positions, Sums& sums) {
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
  if (!has_motion(denoised)) return "motion.X/Y/Z/W (render with --layers motion)";
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
  for (const auto& [images, direction, side] : {std::tuple(&beside.before, TimeDirection::kBefore, "before"),
                                                {&beside.after, TimeDirection::kAfter, "after"}}) {
    PointTracker tracker(own.points, direction);
    SeenPoints last = own.points;
    for (std::size_t k = 0; k < images->size(); ++k) {
      if (const auto checked = check(*(*images)[k]); !checked)
        return fail(fmt::format("{} {}: {}", k + 1, side, checked.error().message));
      DenoisedFrame next = frame_of(*(*images)[k]);
      tracker.follow(last, next.points);
      add_frame(own, next, tracker.positions(), sums);
      last = std::move(next.points);
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
