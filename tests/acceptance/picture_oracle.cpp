#include "tests/acceptance/picture_oracle.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/acceptance/mitsuba_reference.h"
#include "tests/support/oracles.h"

namespace penumbra {

bool PictureAgreement::passed() const {
  return std::abs(mean - 1.0) <= mean_tolerance && accepted >= kPictureAccepted;
}

std::string PictureAgreement::summary() const {
  return fmt::format(
      "means {:.4f} (tolerance {:.4f}); {:.2f} % of the blocks agree (at least {:.0f} %); the worst is "
      "{:.2f} times its limit, at ({}, {}), channel {}",
      mean, mean_tolerance, 100 * accepted, 100 * kPictureAccepted, worst, worst_x, worst_y, worst_channel);
}

std::vector<std::string> picture_names(const std::string& folder, const std::string& extension) {
  const auto root = find_oracle(folder);
  std::vector<std::string> names;
  if (!root) return names;
  for (const auto& entry : std::filesystem::directory_iterator(*root)) {
    const std::filesystem::path& file = entry.path();
    if (file.extension() == "." + extension &&
        std::filesystem::exists(*root / (file.stem().string() + "_ref.exr")))
      names.push_back(file.stem().string());
  }
  std::ranges::sort(names);
  return names;
}

PictureAgreement compare_with_picture(SceneDescription scene, const std::filesystem::path& reference,
                                      std::uint32_t reference_samples, std::uint32_t samples,
                                      const TestDevice& device) {
  const statistics::Image theirs = read_rgb(reference);
  scene.sampler.spp = samples;
  scene.film.closed_light_edges = false;  // which would hide the noise that the other program has there
  const FilmAccumulator film = render_or_throw(scene, device);
  const Film& shown = scene.film;  // of which the picture shows the crop window
  if (shown.crop_width != theirs.width || shown.crop_height != theirs.height)
    throw std::runtime_error(fmt::format("{} has {} x {} pixels, the render {} x {}", reference.string(),
                                         theirs.width, theirs.height, shown.crop_width, shown.crop_height));
  struct Total {
    double ours = 0, theirs = 0, variance = 0;  ///< sums; the variance is that of the difference of the sums
  };
  const auto add = [&](Total& total, int x, int y, int c) {
    const statistics::Sample pixel = pixel_sample(film, shown.crop_x + x, shown.crop_y + y, c);
    total.ours += pixel.mean();
    total.theirs += theirs.at(x, y, c);
    total.variance += pixel.variance() * (1.0 / double(pixel.count()) + 1.0 / double(reference_samples));
  };
  Total all;
  for (int y = 0; y < theirs.height; ++y)
    for (int x = 0; x < theirs.width; ++x)
      for (int c = 0; c < 3; ++c) add(all, x, y, c);
  PictureAgreement result;
  const bool same = all.ours == all.theirs;  // as two black pictures are
  result.mean = same ? 1.0 : all.ours / all.theirs;
  result.mean_tolerance =
      kPictureMean + (same ? 0.0 : kPictureDeviates * std::sqrt(all.variance) / all.theirs);
  constexpr int kPixels = kPictureBlock * kPictureBlock;
  const double dark = kPictureDark * all.theirs / (3.0 * theirs.width * theirs.height) * kPixels;
  int count = 0, accepted = 0;
  for (int y = 0; y + kPictureBlock <= theirs.height; y += kPictureBlock)
    for (int x = 0; x + kPictureBlock <= theirs.width; x += kPictureBlock)
      for (int c = 0; c < 3; ++c) {
        Total block;
        for (int i = 0; i < kPixels; ++i) add(block, x + i % kPictureBlock, y + i / kPictureBlock, c);
        const double limit =
            kPictureLevel * std::max(block.theirs, dark) + kPictureDeviates * std::sqrt(block.variance);
        const double difference = std::abs(block.ours - block.theirs),
                     excess = difference == 0.0 ? 0.0 : difference / limit;
        ++count;
        accepted += excess <= 1.0 ? 1 : 0;
        if (!(excess <= result.worst)) {
          result.worst = excess;
          result.worst_x = x, result.worst_y = y, result.worst_channel = c;
        }
      }
  result.accepted = double(accepted) / count;
  return result;
}

void expect_agreement(const PictureAgreement& agreement, std::string_view name,
                      std::span<const PictureException> exceptions) {
  const auto exception = std::ranges::find(exceptions, name, &PictureException::name);
  if (exception == exceptions.end())
    EXPECT_TRUE(agreement.passed()) << agreement.summary();
  else
    EXPECT_FALSE(agreement.passed()) << "agrees, although the list says: " << exception->reason;
}

}  // namespace penumbra
