#include "scheduler/image/metrics/error_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scheduler/image/metrics/color_map.h"

namespace penumbra {
namespace {

constexpr double kPercentile = 0.99;
constexpr double kLargestZ = 5;

/// Calls combine(values of a pixel's channels, first index) for each finite pixel.
template <typename Error>
ErrorMap map_of(const ImagePair& pair, std::string name, Error error) {
  ErrorMap map{std::move(name), pair.window,
               std::vector<float>(pair.pixels(), std::numeric_limits<float>::quiet_NaN())};
  const std::size_t channels = pair.channels.size();
  for (std::size_t pixel = 0; pixel < pair.pixels(); ++pixel) {
    if (pair.finite[pixel]) map.values[pixel] = float(error(pixel * channels, channels));
  }
  return map;
}

}  // namespace

ErrorMap relative_error_map(const ImagePair& pair, double epsilon) {
  return map_of(pair, "relmse", [&](std::size_t first, std::size_t channels) {
    double sum = 0;
    for (std::size_t i = first; i < first + channels; ++i) {
      const double square = pair.squared_difference(i), truth = pair.truth(i);
      if (square != 0) sum += square / (truth * truth + epsilon);
    }
    return sum / double(channels);
  });
}

ErrorMap absolute_error_map(const ImagePair& pair) {
  return map_of(pair, "abs", [&](std::size_t first, std::size_t channels) {
    double sum = 0;
    for (std::size_t i = first; i < first + channels; ++i) sum += std::abs(pair.difference(i));
    return sum / double(channels);
  });
}

ErrorMap z_map(const ImagePair& pair, const std::vector<float>& z) {
  return map_of(pair, "z", [&](std::size_t first, std::size_t channels) {
    float largest = 0;
    for (std::size_t i = first; i < first + channels; ++i) {
      if (std::abs(z[i]) > largest) largest = std::abs(z[i]);
    }
    return largest;
  });
}

double MapRange::position(double value) const {
  if (!logarithmic) return (value - low) / (high - low);
  return value > 0 ? std::log(value / low) / std::log(high / low) : -std::numeric_limits<double>::infinity();
}

MapRange default_range(const ErrorMap& map) {
  if (map.name == "flip") return {0, 1};
  if (map.name == "z") return {0, kLargestZ};
  std::vector<float> values;
  for (const float value : map.values) {
    if (std::isfinite(value)) values.push_back(value);
  }
  if (values.empty()) return {};
  const auto high = values.begin() + std::ptrdiff_t(kPercentile * double(values.size() - 1));
  std::ranges::nth_element(values, high);
  if (*high > 0) return {0, *high};
  const float largest = std::ranges::max(values);
  return {0, largest > 0 ? largest : 1.0};
}

Image heat_map_image(const ErrorMap& map, const MapRange& range) {
  Image image;
  image.data = map.window;
  image.display = map.window;
  image.channels = {"R", "G", "B", map.name + ".Y"};
  image.values.reserve(map.values.size() * 4);
  for (const float value : map.values) {
    const auto color = std::isnan(value) ? kNoValueColor : heat_color(range.position(value));
    image.values.insert(image.values.end(), color.begin(), color.end());
    image.values.push_back(value);
  }
  image.metadata = {
      {"penumbra:map", map.name}, {"penumbra:low", float(range.low)}, {"penumbra:high", float(range.high)}};
  if (range.logarithmic) image.metadata.emplace_back("penumbra:scale", "logarithmic");
  return image;
}

}  // namespace penumbra
