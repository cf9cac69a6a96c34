#include "scheduler/denoise/guide.h"

#include <algorithm>

namespace penumbra {
namespace {

// Where any channel of the albedo is below, as in glass and in the sky, colours are not divided by it.
constexpr float kLeastAlbedo = 0.05f;

/// What colours are divided by, so that a texture is not taken for noise: the albedo, or 1.
Planes divisors(const Planes& features) {
  Planes divisor = some_planes(features, 0, 3);
  for (std::size_t i = 0; i < divisor.pixels(); ++i) {
    const float least = std::min({divisor.plane(0)[i], divisor.plane(1)[i], divisor.plane(2)[i]});
    for (int c = 0; c < 3 && least < kLeastAlbedo; ++c) divisor.plane(c)[i] = 1;
  }
  return divisor;
}

void divide(Planes& values, const Planes& divisor) {
  for (std::size_t i = 0; i < values.values.size(); ++i) values.values[i] /= divisor.values[i];
}

void multiply(Planes& values, const Planes& factor) {
  for (std::size_t i = 0; i < values.values.size(); ++i) values.values[i] *= factor.values[i];
}

/// Filters each half with the weights of the other, or the image with its own.
Expected<DenoisedImage> filter_halves(DenoiseDevice& device, const DenoiseInput& input,
                                      const NlMeansOptions& options) {
  if (!input.has_halves()) {
    auto color =
        filter(device, make_guide(input.color, input.variance, 1, input.valid), input.color, options);
    if (!color) return std::unexpected(color.error());
    return DenoisedImage{.color = std::move(*color), .residual_variance = {}};
  }
  // A half has twice the variance of the mean of both.
  const auto a =
      filter(device, make_guide(input.half_b, input.variance, 2, input.valid), input.half_a, options);
  if (!a) return std::unexpected(a.error());
  const auto b =
      filter(device, make_guide(input.half_a, input.variance, 2, input.valid), input.half_b, options);
  if (!b) return std::unexpected(b.error());
  return DenoisedImage{.color = mean_of(*a, *b), .residual_variance = quarter_of_squared_difference(*a, *b)};
}

}  // namespace

Expected<DenoisedImage> nl_means(DenoiseDevice& device, const DenoiseInput& input,
                                 const NlMeansOptions& options) {
  const Planes divisor = divisors(input.features);
  DenoiseInput divided = input;
  for (Planes* planes :
       {&divided.color, &divided.half_a, &divided.half_b, &divided.variance, &divided.variance})
    divide(*planes, divisor);
  auto denoised = filter_halves(device, divided, options);
  if (!denoised) return denoised;
  for (Planes* planes : {&denoised->color, &denoised->residual_variance, &denoised->residual_variance})
    multiply(*planes, divisor);
  return denoised;
}

}  // namespace penumbra
