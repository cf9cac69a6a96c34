#include "tests/acceptance/mitsuba_reference.h"

#include <limits>
#include <stdexcept>

#include "scheduler/image/image.h"

namespace penumbra {

statistics::Image read_rgb(const std::filesystem::path& path) {
  const auto file = read_image(path);
  if (!file) throw std::runtime_error(file.error().message);
  const auto channels = file->beauty_channels();
  if (!channels) throw std::runtime_error(path.string() + " has no colour channels");
  statistics::Image image(file->data.width, file->data.height, 3);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = file->at(x, y, (*channels)[c]);
    }
  }
  return image;
}

statistics::Estimate mitsuba_blocks(const std::filesystem::path& folder) {
  // What 1024 to 1536 samples a pixel know of a block's standard error is exact beside a test's few batches.
  return {.mean = read_rgb(folder / "mitsuba_ref_4x4.exr"),
          .standard_error = read_rgb(folder / "mitsuba_ref_4x4_stderr.exr"),
          .dof = std::numeric_limits<double>::infinity()};
}

}  // namespace penumbra
