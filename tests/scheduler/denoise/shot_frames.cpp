#include "tests/scheduler/denoise/shot_frames.h"

#include <cmath>
#include <random>
#include <string>

namespace penumbra {

Image frame_of(const Truth& truth, float sigma, std::uint32_t seed, float speed) {
  Image image;
  image.data = image.display = {0, 0, kFrameWidth, kFrameHeight};
  image.channels = {"R",        "G",        "B",        "variance.R", "variance.G", "variance.B",
                    "motion.X", "motion.Y", "motion.Z", "motion.W",   "albedo.R",   "albedo.G",
                    "albedo.B", "normal.X", "normal.Y", "normal.Z",   "depth.Z",    "half_a.R",
                    "half_a.G", "half_a.B", "half_b.R", "half_b.G",   "half_b.B"};
  image.metadata = {{"penumbra:film_hash", std::to_string(seed)}};
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0, 1);
  for (int y = 0; y < kFrameHeight; ++y)
    for (int x = 0; x < kFrameWidth; ++x) {
      float halves[6];
      for (float& half : halves) half = truth(x, y) + sigma * std::sqrt(2.0f) * noise(random);
      for (int c = 0; c < 3; ++c) image.values.push_back((halves[c] + halves[3 + c]) / 2);
      image.values.insert(image.values.end(), 3, sigma * sigma);
      image.values.insert(image.values.end(), {-speed, 0, speed, 0, 1, 1, 1, 0, 0, 1, 5});
      image.values.insert(image.values.end(), halves, halves + 6);
    }
  return image;
}

}  // namespace penumbra
