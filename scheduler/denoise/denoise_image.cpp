#include "scheduler/denoise/denoise_image.h"

#include <algorithm>
#include <utility>

#include "scenes/settings.h"
#include "scheduler/denoise/oidn.h"

namespace penumbra {
namespace {

Expected<DenoisedImage> denoise(const DenoiseInput& input, const DenoiseOptions& options) {
  if (options.method == Denoise::kOidn) return oidn(input);
  auto device = make_denoise_device(options.device);
  if (!device) return std::unexpected(device.error());
  return options.method == Denoise::kNlMeans ? nl_means(**device, input, options.nl_means)
                                             : nfor(**device, input);
}

/// The image with more channels at the end, before those that are exact.
Image with_channels(const Image& image, std::span<const std::string> names, const Planes& values) {
  Image result = image;
  const std::size_t before = image.channels.size() - image.exact_channels, more = names.size();
  result.channels.insert(result.channels.begin() + std::ptrdiff_t(before), names.begin(), names.end());
  result.values.clear();
  result.values.reserve(image.pixels() * result.channels.size());
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const auto pixel = image.values.begin() + std::ptrdiff_t(i * image.channels.size());
    result.values.insert(result.values.end(), pixel, pixel + std::ptrdiff_t(before));
    for (std::size_t k = 0; k < more; ++k) result.values.push_back(values.plane(int(k))[i]);
    result.values.insert(result.values.end(), pixel + std::ptrdiff_t(before),
                         pixel + std::ptrdiff_t(image.channels.size()));
  }
  return result;
}

}  // namespace

std::string method_name(Denoise method) {
  RenderSettings settings;
  settings.film.denoise = method;
  return print_setting(settings, "film.denoise");
}

Expected<void> check_denoiser(Denoise method) {
  return method == Denoise::kOidn ? check_oidn() : Expected<void>();
}

Expected<DenoiseOutcome> denoise_image(const Image& noisy, const DenoiseOptions& options) {
  if (noisy.attribute("penumbra:denoised_by"))
    return fail("it is denoised already: denoise the image that it was made from");
  DenoiseOutcome outcome;
  auto scaled = denoise_input(noisy, &outcome.remarks);
  if (!scaled) return std::unexpected(scaled.error());
  auto denoised = denoise(scaled->input, options);
  if (!denoised) return std::unexpected(denoised.error());
  const float back = 1 / scaled->scale;
  if (denoised->residual_variance.count > 0) {
    for (float& value : denoised->residual_variance.values) value *= back * back;
    const std::string names[] = {"error.R", "error.G", "error.B"};
    outcome.image = with_channels(noisy, names, denoised->residual_variance);
  } else {
    outcome.image = noisy;
  }
  Image& image = outcome.image;
  for (std::string& name : image.channels)
    if (name.starts_with("variance.")) name = "noisy_" + name;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < image.pixels(); ++i)
      image.values[i * image.channels.size() + scaled->channels[c]] = denoised->color.plane(int(c))[i] * back;
  std::erase_if(image.metadata, [](const auto& entry) { return describes_file(entry.first); });
  image.metadata.emplace_back("penumbra:denoised_by", method_name(options.method));
  return outcome;
}

}  // namespace penumbra
