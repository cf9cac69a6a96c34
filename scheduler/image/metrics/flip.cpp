#include "scheduler/image/metrics/flip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scheduler/image/metrics/color_space.h"
#include "scheduler/image/metrics/flip_core.h"

namespace penumbra {
namespace {

// Section 4 of the paper of 2020.
constexpr double kColorExponent = 0.7, kKneeIn = 0.4, kKneeOut = 0.95;
constexpr double kFeatureExponent = 0.5;

/// YCxCz, the linearised CIELAB of Flohr et al. 1993, an opponent space in which contrast sensitivities are
/// known.
std::array<Plane, 3> opponent_planes(const LinearPlanes& rgb) {
  std::array<Plane, 3> result;
  result.fill(Plane(rgb[0].width, rgb[0].height));
  for (std::size_t i = 0; i < rgb[0].values.size(); ++i) {
    const Color xyz = relative_xyz_from_rgb({rgb[0].values[i], rgb[1].values[i], rgb[2].values[i]});
    result[0].values[i] = float(116 * xyz[1] - 16);
    result[1].values[i] = float(500 * (xyz[0] - xyz[1]));
    result[2].values[i] = float(200 * (xyz[1] - xyz[2]));
  }
  return result;
}

Color rgb_from_opponent(const Color& opponent) {
  const double y = (opponent[0] + 16) / 116;
  return rgb_from_relative_xyz({y + opponent[1] / 500, y, y - opponent[2] / 200});
}

/// CIELAB with reduced chroma in dark regions (Hunt effect).
Color hunt_lab(const Color& rgb) {
  const Color lab = lab_from_relative_xyz(relative_xyz_from_rgb(rgb));
  return {lab[0], 0.01 * lab[0] * lab[1], 0.01 * lab[0] * lab[2]};
}

/// The HyAB distance for large differences (Abasi et al. 2020): city block in lightness, Euclidean in the
/// other coordinates.
double hyab(const Color& a, const Color& b) {
  const double da = a[1] - b[1], db = a[2] - b[2];
  return std::abs(a[0] - b[0]) + std::sqrt(da * da + db * db);
}

/// Maps differences from 0 up to that of green and blue to [0, 1], with most of the range for small
/// differences.
double remapped_color_error(double difference) {
  static const double largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), kColorExponent);
  const double power = std::pow(difference, kColorExponent), knee = kKneeIn * largest;
  const double error =
      power < knee ? kKneeOut * power / knee : kKneeOut + (power - knee) / (largest - knee) * (1 - kKneeOut);
  return std::min(error, 1.0);
}

/// One filtered image, before the images are compared.
struct Seen {
  std::array<Plane, 3> filtered;  // opponent channels
  Plane edges, points;
};

Seen see(const LinearPlanes& rgb, double pixels_per_degree) {
  constexpr std::array kSensitivities{kLightSensitivity, kRedGreenSensitivity, kBlueYellowSensitivity};
  std::array<Plane, 3> opponent = opponent_planes(rgb);
  Seen seen;
  for (std::size_t c = 0; c < 3; ++c)
    seen.filtered[c] = filter_by_sensitivity(opponent[c], kSensitivities[c], pixels_per_degree);
  Plane& light = opponent[0];
  for (float& value : light.values) value = (value + 16) / 116;
  seen.edges = edge_response(light, pixels_per_degree);
  seen.points = point_response(light, pixels_per_degree);
  return seen;
}

Color seen_color(const Seen& seen, std::size_t i) {
  Color rgb =
      rgb_from_opponent({seen.filtered[0].values[i], seen.filtered[1].values[i], seen.filtered[2].values[i]});
  for (double& value : rgb) value = std::clamp(value, 0.0, 1.0);
  return hunt_lab(rgb);
}

}  // namespace

Plane flip_of_linear_light(const LinearPlanes& reference, const LinearPlanes& image,
                           double pixels_per_degree) {
  const Seen a = see(image, pixels_per_degree), b = see(reference, pixels_per_degree);
  Plane result(image[0].width, image[0].height);
  for_bands(result.height, [&](int y0, int y1) {
    const std::size_t width = std::size_t(result.width);
    for (std::size_t i = std::size_t(y0) * width; i < std::size_t(y1) * width; ++i) {
      const double color = remapped_color_error(hyab(seen_color(a, i), seen_color(b, i)));
      const double edge = std::abs(double(a.edges.values[i]) - b.edges.values[i]);
      const double point = std::abs(double(a.points.values[i]) - b.points.values[i]);
      const double feature =
          std::min(std::pow(std::max(edge, point) * std::numbers::sqrt2 / 2, kFeatureExponent), 1.0);
      result.values[i] = float(std::pow(color, 1 - feature));
    }
  });
  return result;
}

Expected<void> check_flip_input(const ImagePair& pair, double pixels_per_degree) {
  if (pair.channels.size() != 1 && pair.channels.size() != 3) {
    return fail(fmt::format("FLIP is of colours, not of {} channels", pair.channels.size()));
  }
  if (!(pixels_per_degree >= 1 && pixels_per_degree <= 10000)) {
    return fail(fmt::format("{} pixels per degree: FLIP takes 1 to 10000", pixels_per_degree));
  }
  return {};
}

FlipResult flip_summary(const ImagePair& pair, Plane error, double pixels_per_degree) {
  FlipResult result;
  result.pixels = std::move(error.values);
  result.pixels_per_degree = pixels_per_degree;
  double sum = 0;  // of terms in [0, 1]
  for (std::size_t pixel = 0; pixel < pair.pixels(); ++pixel) {
    float& value = result.pixels[pixel];
    if (!pair.finite[pixel]) {
      value = std::numeric_limits<float>::quiet_NaN();
      continue;
    }
    sum += value;
    if (value > result.largest) {
      result.largest = value;
      result.x = pair.window.x + int(pixel % std::size_t(pair.window.width));
      result.y = pair.window.y + int(pixel / std::size_t(pair.window.width));
    }
  }
  result.mean = sum / double(pair.compared_pixels);
  return result;
}

Expected<FlipResult> flip_of_display_images(const ImagePair& pair, double pixels_per_degree) {
  if (const auto usable = check_flip_input(pair, pixels_per_degree); !usable) {
    return std::unexpected(usable.error());
  }
  const auto linear = [](double signal) { return linear_from_srgb(std::clamp(signal, 0.0, 1.0)); };
  const LinearPlanes reference = planes_of(pair, [&](std::size_t i) { return linear(pair.truth(i)); });
  const LinearPlanes image = planes_of(pair, [&](std::size_t i) { return linear(pair.value(i)); });
  return flip_summary(pair, flip_of_linear_light(reference, image, pixels_per_degree), pixels_per_degree);
}

}  // namespace penumbra
