#include "tests/scheduler/denoise/shot_frames.h"

#include <random>
#include <string>

namespace penumbra {

Image frame_of(const Truth& truth, float sigma, std::uint32_t seed, int speed) {
  Image image;
  image.data = image.display = {0, 0, kFrameWidth, kFrameHeight};
  image.channels = {"R",        "G",        "B",        "error.R",  "error.G",  "error.B",
                    "motion.X", "motion.Y", "motion.Z", "motion.W", "albedo.R", "albedo.G",
                    "albedo.B", "normal.X", "normal.Y", "normal.Z", "depth.Z"};
  image.metadata = {{"penumbra:film_hash", std::to_string(seed)}};
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0, 1);
  for (int y = 0; y < kFrameHeight; ++y)
    for (int x = 0; x < kFrameWidth; ++x) {
      for (int c = 0; c < 3; ++c) image.values.push_back(truth(x, y) + sigma * noise(random));
      image.values.insert(image.values.end(), 3, sigma * sigma);
      image.values.insert(image.values.end(), {float(-speed), 0, float(speed), 0, 1, 1, 1, 0, 0, 1, 5});
    }
  return image;
}

}  // namespace penumbra
