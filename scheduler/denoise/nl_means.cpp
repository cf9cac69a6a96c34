#include "scheduler/denoise/guide.h"

namespace penumbra {

Expected<DenoisedImage> nl_means(DenoiseDevice& device, const DenoiseInput& input,
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

}  // namespace penumbra
