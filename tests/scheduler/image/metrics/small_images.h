// Images for tests of metrics.
#pragma once

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "scheduler/image/metrics/image_pair.h"
#include "tests/support/normal_deviates.h"

namespace penumbra {

inline Image image_of(int width, int height, std::vector<float> values,
                      std::vector<std::string> channels = {"R", "G", "B"}) {
  Image image;
  image.data = image.display = {0, 0, width, height};
  image.channels = std::move(channels);
  image.values = std::move(values);
  return image;
}

inline Image grey_image(int width, int height, std::vector<float> values) {
  return image_of(width, height, std::move(values), {"Y"});
}

inline ImagePair pair_of(const Image& image, const Image& reference) {
  return pair_images(image, reference).value();
}

/// Uniform in [0, 1), the same everywhere.
inline double hashed(std::uint64_t index, std::uint64_t seed) {
  return double(std::uint32_t(index * 2654435761u + seed * 40503u) >> 8) / double(1 << 24);
}

/// mean + deviation * normal deviate, fixed seed.
inline std::vector<float> noisy(const std::vector<double>& mean, double deviation, std::uint32_t seed) {
  std::mt19937_64 random(seed);
  NormalDeviates normal;
  std::vector<float> values;
  for (const double m : mean) values.push_back(float(m + deviation * normal(random)));
  return values;
}

}  // namespace penumbra
