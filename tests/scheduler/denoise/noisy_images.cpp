#include "tests/scheduler/denoise/noisy_images.h"

#include <cmath>
#include <random>

#include "scheduler/denoise/guide.h"

namespace penumbra {

DenoiseInput noisy_image(int width, int height, const std::function<float(int x, int y, int c)>& truth,
                         float sigma, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0, sigma * std::sqrt(2.0f));
  DenoiseInput input;
  input.half_a = input.half_b = Planes(width, height, 3);
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto i = std::size_t(y * width + x);
        input.half_a.plane(c)[i] = truth(x, y, c) + (sigma > 0 ? noise(random) : 0);
        input.half_b.plane(c)[i] = truth(x, y, c) + (sigma > 0 ? noise(random) : 0);
      }
  input.color = mean_of(input.half_a, input.half_b);
  input.variance = Planes(width, height, 3, sigma * sigma);
  input.features = input.feature_variance = Planes(width, height, REGRESSION_FEATURES);
  input.valid = Planes(width, height, 1, 1.0f);
  return input;
}

double rms_error(const Planes& image, const std::function<float(int x, int y, int c)>& truth) {
  double sum = 0;
  for (int c = 0; c < image.count; ++c)
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        sum += std::pow(double(image.plane(c)[std::size_t(y * image.width + x)]) - double(truth(x, y, c)), 2);
  return std::sqrt(sum / double(image.values.size()));
}

std::unique_ptr<DenoiseDevice> test_device() {
  DeviceOptions options;
  options.threads = 2;
  options.isa = best_isa();
  return std::move(*make_denoise_device(options));
}

Planes crop(const Planes& image, int x, int y, int width, int height) {
  Planes part(width, height, image.count);
  for (int k = 0; k < image.count; ++k)
    for (int row = 0; row < height; ++row)
      for (int column = 0; column < width; ++column)
        part.plane(k)[std::size_t(row * width + column)] =
            image.plane(k)[std::size_t((y + row) * image.width + x + column)];
  return part;
}

DenoiseInput crop(const DenoiseInput& input, int x, int y, int width, int height) {
  const auto part = [&](const Planes& planes) { return crop(planes, x, y, width, height); };
  return {.color = part(input.color),
          .variance = part(input.variance),
          .half_a = part(input.half_a),
          .half_b = part(input.half_b),
          .features = part(input.features),
          .feature_variance = part(input.feature_variance),
          .valid = part(input.valid)};
}

}  // namespace penumbra
