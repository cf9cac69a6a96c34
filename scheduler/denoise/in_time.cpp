#include "scheduler/denoise/in_time.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "kernels/host/parallel.h"
#include "kernels/math/math.h"
#include "scheduler/denoise/denoise_image.h"
#include "scheduler/denoise/guide.h"
#include "scheduler/denoise/layers.h"

namespace penumbra {
namespace {

constexpr int kPatchRadius = 3, kFeaturePatchRadius = 1;
constexpr float kStrength = 1;         // deviations that still count as noise
constexpr float kLeastAlbedo = 0.05f;  // light is divided by no less
constexpr float kLeastNoise = 1e-3f;   // relative; differences below are none
constexpr float kMostDistance = 1e6f;
// Albedo, normal, depth.
constexpr int kGroups = 3, kDepthGroup = 2;
constexpr int kGroupPlanes[kGroups] = {3, 3, 1}, kFirstPlane[kGroups] = {0, 3, 6};

/// Sums over frames, with weights of their own for each half and for the features.
struct Sums {
  Planes halves[2], noise, features, feature_noise;
  Planes half_weights[2], feature_weights;  // 1 plane each
};

/// Albedo that light is divided by.
float divisor(float albedo) { return albedo > kLeastAlbedo ? albedo : kLeastAlbedo; }

/// The channels of an image that are blended.
struct LayersInTime {
  explicit LayersInTime(const Image& image)
      : halves{find_layer(image, {"half_a"}, {"RGB"}), find_layer(image, {"half_b"}, {"RGB"})},
        noise(find_layer(image, {"variance"}, {"RGB"})) {
    if (const auto rgb = image.beauty_channels()) color.assign(rgb->begin(), rgb->end());
    const std::pair<const char*, const char*> names[] = {
        {"albedo", "RGB"}, {"normal", "XYZ"}, {"depth", "Z"}};
    for (std::size_t group = 0; group < kGroups; ++group) {
      const auto& [name, letters] = names[group];
      const auto values = find_layer(image, {name}, {letters});
      const auto variances = find_layer(image, {fmt::format("{}_variance", name)}, {letters});
      for (std::size_t k = 0; k < values.size(); ++k) features[kFirstPlane[group] + k] = values[k];
      for (std::size_t k = 0; k < variances.size(); ++k) feature_noise[kFirstPlane[group] + k] = variances[k];
    }
  }
  std::vector<std::size_t> color, halves[2], noise;
  std::array<std::optional<std::size_t>, REGRESSION_FEATURES> features, feature_noise;
};

const Planes& feature_group(const FrameInTime& frame, int group) {
  return group == 0 ? frame.albedo : group == 1 ? frame.points.normal : frame.points.depth;
}

/// The squared difference of values of two frames beyond their variances, in units of these; as in
/// kernels/denoise/non_local_means.h.
float distance(float own, float other, float own_noise, float other_noise, float least) {
  const float beyond = sqr(own - other) - (own_noise + std::min(own_noise, other_noise));
  const float unit = sqr(least) + sqr(kStrength) * (own_noise + other_noise);
  return beyond == 0 && unit == 0 ? 0 : beyond / unit;
}

/// Weights exp(-max(0, d)), d: the mean of distances over a patch where points are found.
Planes weights_of(const Planes& distances, const Planes& found, int patch_radius) {
  Planes weights = box_mean(distances, patch_radius);
  const Planes shares = box_mean(found, patch_radius);
  for (int k = 0; k < weights.count; ++k)
    for (std::size_t i = 0; i < weights.pixels(); ++i) {
      float& weight = weights.plane(k)[i];
      weight = found.values[i] > 0 ? exp_f(-std::max(std::min(weight / shares.values[i], 1e3f), 0.0f)) : 0.0f;
    }
  return weights;
}

/// What another frame shows of a frame's points, and how far it differs.
struct Warped {
  Planes halves[2], noise, features, feature_noise;
  Planes distances, feature_distances;  // 2 planes: of the halves; 3: of albedo, normal, depth
  Planes found, features_found;         // 1 plane each: 0 where a point is lost or a value is not finite
};

/// One pixel of it.
void warp_pixel(const FrameInTime& frame, const FrameInTime& other, std::size_t i, PointPosition at,
                Warped& to) {
  const auto taps = alike_taps(frame.points, i, other.points, at);
  if (!taps) return;
  float distances[2] = {0, 0};
  for (int c = 0; c < 3; ++c) {
    // Interpolated noise is correlated, so filters average it less: its variance is taken as that of pixels.
    to.noise.plane(c)[i] = taps->mean(other.noise, c);
    const float own_noise = frame.noise.plane(c)[i], other_noise = taps->variance(other.noise, c);
    for (int h = 0; h < 2; ++h) {
      const float own = frame.halves[h].plane(c)[i];
      const float value = to.halves[h].plane(c)[i] = taps->mean(other.halves[h], c);
      // A half's weight comes from the other half, which has twice the variance of the mean of both.
      distances[1 - h] += distance(own, value, 2 * own_noise, 2 * other_noise, kLeastNoise * own) / 3;
    }
  }
  if (!std::isfinite(distances[0]) || !std::isfinite(distances[1])) return;
  to.found.values[i] = 1;
  for (int h = 0; h < 2; ++h) to.distances.plane(h)[i] = std::min(distances[h], kMostDistance);
  float all = 0;
  for (int group = 0; group < 3; ++group) {
    const int planes = kGroupPlanes[group];
    float sum = 0;
    for (int k = 0; k < planes; ++k) {
      const int plane = kFirstPlane[group] + k;
      const float own = feature_group(frame, group).plane(k)[i];
      const float value = to.features.plane(plane)[i] = taps->mean(feature_group(other, group), k);
      const float noise = to.feature_noise.plane(plane)[i] = taps->variance(other.feature_noise, plane);
      const float unit = group == kDepthGroup ? own : 1;
      sum += distance(own, value, frame.feature_noise.plane(plane)[i], noise, kLeastNoise * unit);
    }
    all += sum;
    to.feature_distances.plane(group)[i] =
        std::isfinite(sum) ? std::min(sum / float(planes), kMostDistance) : 0;
  }
  to.features_found.values[i] = std::isfinite(all) ? 1 : 0;
}

void add(const Planes& values, float weight, std::size_t i, Planes& sums) {
  for (int k = 0; k < values.count; ++k) sums.plane(k)[i] += weight * values.plane(k)[i];
}

/// Adds what another frame shows of the same points.
void add_frame(const FrameInTime& frame, const FrameInTime& other,
               const std::vector<std::optional<PointPosition>>& positions, std::size_t threads, Sums& sums) {
  const int width = frame.noise.width, height = frame.noise.height;
  const auto planes = [&](int count) { return Planes(width, height, count); };
  Warped seen{.halves = {planes(3), planes(3)},
              .noise = planes(3),
              .features = planes(REGRESSION_FEATURES),
              .feature_noise = planes(REGRESSION_FEATURES),
              .distances = planes(2),
              .feature_distances = planes(3),
              .found = planes(1),
              .features_found = planes(1)};
  const auto for_rows = [&](const auto& body) {
    in_parallel(std::size_t(height), threads, [&](std::size_t row) {
      for (std::size_t i = row * std::size_t(width); i < (row + 1) * std::size_t(width); ++i) body(i);
    });
  };
  for_rows([&](std::size_t i) {
    if (positions[i]) warp_pixel(frame, other, i, *positions[i], seen);
  });
  const Planes weights = weights_of(seen.distances, seen.found, kPatchRadius);
  const Planes alike = weights_of(seen.feature_distances, seen.features_found, kFeaturePatchRadius);
  for_rows([&](std::size_t i) {
    if (!(seen.found.values[i] > 0)) return;
    const float of_halves[2] = {weights.plane(0)[i], weights.plane(1)[i]};
    const float of_both = (of_halves[0] + of_halves[1]) / 2;
    for (int h = 0; h < 2; ++h) {
      sums.half_weights[h].values[i] += of_halves[h];
      add(seen.halves[h], of_halves[h], i, sums.halves[h]);
    }
    add(seen.noise, sqr(of_both), i, sums.noise);
    const float of_features = of_both * std::min({alike.plane(0)[i], alike.plane(1)[i], alike.plane(2)[i]});
    if (!(of_features > 0)) return;
    sums.feature_weights.values[i] += of_features;
    add(seen.features, of_features, i, sums.features);
    add(seen.feature_noise, sqr(of_features), i, sums.feature_noise);
  });
}

/// The frame's image with the means. Pixels without light of other frames stay as they are.
Image with_means(const FrameInTime& frame, const Sums& sums) {
  Image image = frame.image;
  const LayersInTime layers(image);
  const std::size_t channels = image.channels.size();
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const float of_halves[2] = {sums.half_weights[0].values[i], sums.half_weights[1].values[i]};
    const float of_both = (of_halves[0] + of_halves[1]) / 2, of_features = sums.feature_weights.values[i];
    if (of_both == 1) continue;
    float* pixel = image.values.data() + i * channels;
    for (int k = 0; k < REGRESSION_FEATURES; ++k) {
      if (const auto channel = layers.features[k]) pixel[*channel] = sums.features.plane(k)[i] / of_features;
      if (const auto channel = layers.feature_noise[k])
        pixel[*channel] = sums.feature_noise.plane(k)[i] / sqr(of_features);
    }
    for (int c = 0; c < 3; ++c) {
      const float albedo = layers.features[c] ? divisor(sums.features.plane(c)[i] / of_features) : 1;
      float both = 0;
      for (int h = 0; h < 2; ++h) {
        const float value = albedo * sums.halves[h].plane(c)[i] / of_halves[h];
        pixel[layers.halves[h][c]] = value;
        both += value / 2;
      }
      pixel[layers.color[c]] = both;
      pixel[layers.noise[c]] = sqr(albedo) * sums.noise.plane(c)[i] / sqr(of_both);
    }
  }
  return image;
}

}  // namespace

std::string lacks_for_time(const Image& noisy) {
  const LayersInTime layers(noisy);
  if (layers.color.empty()) return "R, G, B";
  if (!has_motion(noisy)) return "motion.X/Y/Z/W (render with --layers motion)";
  if (layers.halves[0].empty() || layers.halves[1].empty() || layers.noise.empty())
    return "half_a, half_b or variance (render with --denoise=layers)";
  return "";
}

FrameInTime frame_in_time(Image noisy) {
  const LayersInTime layers(noisy);
  FrameInTime frame{.image = std::move(noisy)};
  const Image& image = frame.image;
  for (int h = 0; h < 2; ++h) frame.halves[h] = planes_of(image, layers.halves[h]);
  frame.noise = planes_of(image, layers.noise);
  frame.points = seen_points(image);
  frame.albedo = Planes(image.data.width, image.data.height, 3);
  frame.feature_noise = Planes(image.data.width, image.data.height, REGRESSION_FEATURES);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const float* pixel = image.values.data() + i * image.channels.size();
    for (int k = 0; k < REGRESSION_FEATURES; ++k)
      if (const auto channel = layers.feature_noise[k]) frame.feature_noise.plane(k)[i] = pixel[*channel];
    for (int c = 0; c < 3; ++c) {
      const auto channel = layers.features[c];
      frame.albedo.plane(c)[i] = channel ? pixel[*channel] : 0;
      const float albedo = channel ? divisor(pixel[*channel]) : 1;
      frame.noise.plane(c)[i] /= sqr(albedo);
      for (Planes& half : frame.halves) half.plane(c)[i] /= albedo;
    }
  }
  return frame;
}

Image blended_in_time(const FrameInTime& frame, const FramesBeside& beside, std::size_t threads) {
  const int width = frame.noise.width, height = frame.noise.height;
  const Planes ones(width, height, 1, 1.0f);
  Sums sums{.halves = {frame.halves[0], frame.halves[1]},
            .noise = frame.noise,
            .features = Planes(width, height, REGRESSION_FEATURES),
            .feature_noise = frame.feature_noise,
            .half_weights = {ones, ones},
            .feature_weights = ones};
  for (int group = 0; group < 3; ++group)
    std::ranges::copy(feature_group(frame, group).values, sums.features.plane(kFirstPlane[group]).begin());
  for (const auto& [frames, direction] :
       {std::pair(&beside.before, TimeDirection::kBefore), {&beside.after, TimeDirection::kAfter}}) {
    PointTracker tracker(frame.points, direction);
    const SeenPoints* last = &frame.points;
    for (const FrameInTime* next : *frames) {
      tracker.follow(*last, next->points);
      add_frame(frame, *next, tracker.positions(), threads, sums);
      last = &next->points;
    }
  }
  return with_means(frame, sums);
}

std::string hashes_of(const std::vector<const Image*>& images) {
  std::vector<std::string> hashes;
  for (const Image* image : images) {
    const std::string hash = metadata_text(*image, kFilmHash);
    hashes.push_back(hash.empty() ? "?" : hash);
  }
  return fmt::format("{}", fmt::join(hashes, " "));
}

}  // namespace penumbra
