#include "scheduler/denoise/denoise_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "scenes/settings.h"
#include "scheduler/denoise/layers.h"
#include "scheduler/denoise/oidn.h"

namespace penumbra {
namespace {

Expected<DenoisedImage> denoise(DenoiseInput input, const DenoiseOptions& options) {
  if (options.method == Denoise::kOidn) return oidn(input);
  auto device = make_denoise_device(options.device);
  if (!device) return std::unexpected(device.error());
  return options.method == Denoise::kNlMeans ? nl_means(**device, std::move(input), options.nl_means)
                                             : nfor(**device, std::move(input));
}

}  // namespace

std::string method_name(Denoise method) {
  RenderSettings settings;
  settings.film.denoise = method;
  return print_setting(settings, "film.denoise");
}

std::string denoiser_name(const DenoiseOptions& options) {
  const std::string name = method_name(options.method);
  if (options.method != Denoise::kNlMeans || options.nl_means == NlMeansOptions()) return name;
  return fmt::format("{} search_radius={} patch_radius={} strength={}", name, options.nl_means.search_radius,
                     options.nl_means.patch_radius, options.nl_means.strength);
}

Expected<void> check_denoiser(Denoise method) {
  return method == Denoise::kOidn ? check_oidn() : Expected<void>();
}

Expected<DenoiseOutcome> denoise_image(const Image& noisy, const DenoiseOptions& options) {
  if (noisy.attribute(kDenoisedBy))
    return fail("it is denoised already: denoise the image that it was made from");
  DenoiseOutcome outcome;
  auto scaled = denoise_input(noisy, &outcome.remarks);
  if (!scaled) return std::unexpected(scaled.error());
  auto denoised = denoise(std::move(scaled->input), options);
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
  for (float& value : denoised->color.values) value *= back;
  set_channels(image, scaled->channels, denoised->color);
  std::erase_if(image.metadata, [](const auto& entry) { return describes_file(entry.first); });
  image.metadata.emplace_back(kDenoisedBy, denoiser_name(options));
  return outcome;
}

}  // namespace penumbra
