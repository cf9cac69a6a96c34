#include "scheduler/outputs/compare.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace penumbra {
namespace {

/// Keeps the relative error of black pixels finite.
constexpr double kRelativeMseFloor = 0.01;

bool is_finite(const Image& image, std::size_t pixel, const std::array<std::size_t, 3>& channels) {
  for (const std::size_t channel : channels) {
    if (!std::isfinite(image.values[pixel * image.channels.size() + channel])) return false;
  }
  return true;
}

std::string join_channels(const Image& image) { return fmt::format("{}", fmt::join(image.channels, ", ")); }

/// JSON has no NaN or infinity; null stands for them.
nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

double Comparison::mean_ratio(int channel) const {
  return image_mean[std::size_t(channel)] / reference_mean[std::size_t(channel)];
}

Expected<Comparison> compare_images(const Image& image, const Image& reference) {
  if (image.data.width != reference.data.width || image.data.height != reference.data.height) {
    return fail(fmt::format("the sizes differ: {} x {} against {} x {}", image.data.width, image.data.height,
                            reference.data.width, reference.data.height));
  }
  const auto image_channels = image.beauty_channels();
  const auto reference_channels = reference.beauty_channels();
  if (!image_channels) return fail("the image has no channels R, G, B; it has " + join_channels(image));
  if (!reference_channels)
    return fail("the reference has no channels R, G, B; it has " + join_channels(reference));

  Comparison result;
  result.width = image.data.width;
  result.height = image.data.height;
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    const bool image_finite = is_finite(image, pixel, *image_channels);
    const bool reference_finite = is_finite(reference, pixel, *reference_channels);
    result.image_non_finite += !image_finite;
    result.reference_non_finite += !reference_finite;
    if (!image_finite || !reference_finite) continue;
    ++result.compared_pixels;
    for (std::size_t c = 0; c < 3; ++c) {
      const double value = image.values[pixel * image.channels.size() + (*image_channels)[c]];
      const double truth = reference.values[pixel * reference.channels.size() + (*reference_channels)[c]];
      const double d = value - truth;
      result.mse += d * d;
      result.relative_mse += d * d / (truth * truth + kRelativeMseFloor);
      result.image_mean[c] += value;
      result.reference_mean[c] += truth;
      if (std::abs(d) > result.max_difference) {
        result.max_difference = std::abs(d);
        result.max_x = int(pixel % std::size_t(image.data.width));
        result.max_y = int(pixel / std::size_t(image.data.width));
      }
    }
  }
  if (result.compared_pixels == 0) return fail("no pixel is finite in both images");
  const double pixels = double(result.compared_pixels);
  result.mse /= 3 * pixels;
  result.relative_mse /= 3 * pixels;
  for (std::size_t c = 0; c < 3; ++c) {
    result.image_mean[c] /= pixels;
    result.reference_mean[c] /= pixels;
  }
  return result;
}

std::string comparison_text(const Comparison& c) {
  std::string text = fmt::format(
      "{} x {} pixels, d = A - B, B is the reference\n"
      "relMSE       {:.6g}   mean of d^2 / (B^2 + {})\n"
      "MSE          {:.6g}\n"
      "max |d|      {:.6g}   at pixel {},{}\n"
      "                     R            G            B\n"
      "mean of A    {:12.6g} {:12.6g} {:12.6g}\n"
      "mean of B    {:12.6g} {:12.6g} {:12.6g}\n"
      "A / B        {:12.6f} {:12.6f} {:12.6f}\n",
      c.width, c.height, c.relative_mse, kRelativeMseFloor, c.mse, c.max_difference, c.max_x, c.max_y,
      c.image_mean[0], c.image_mean[1], c.image_mean[2], c.reference_mean[0], c.reference_mean[1],
      c.reference_mean[2], c.mean_ratio(0), c.mean_ratio(1), c.mean_ratio(2));
  if (c.image_non_finite + c.reference_non_finite > 0) {
    text += fmt::format("left out, as NaN or infinite: {} pixels of A, {} of B\n", c.image_non_finite,
                        c.reference_non_finite);
  }
  return text;
}

nlohmann::ordered_json comparison_json(const Comparison& c) {
  return {{"width", c.width},
          {"height", c.height},
          {"relative_mse", number(c.relative_mse)},
          {"mse", number(c.mse)},
          {"max_difference", number(c.max_difference)},
          {"max_difference_pixel", {c.max_x, c.max_y}},
          {"image_mean", {c.image_mean[0], c.image_mean[1], c.image_mean[2]}},
          {"reference_mean", {c.reference_mean[0], c.reference_mean[1], c.reference_mean[2]}},
          {"mean_ratio", {number(c.mean_ratio(0)), number(c.mean_ratio(1)), number(c.mean_ratio(2))}},
          {"compared_pixels", c.compared_pixels},
          {"image_non_finite_pixels", c.image_non_finite},
          {"reference_non_finite_pixels", c.reference_non_finite}};
}

}  // namespace penumbra
