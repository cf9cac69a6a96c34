#include "tests/acceptance/mitsuba_reference.h"

#include <cmath>
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

statistics::Estimate mitsuba_blocks(const std::filesystem::path& folder, int size) {
  // What 1024 to 1536 samples a pixel know of a block's standard error is exact beside a test's few batches.
  const int blocks = size / 4;  // of a side
  statistics::Image error = read_rgb(folder / "mitsuba_ref_4x4_stderr.exr");
  for (double& value : error.values) value *= value;
  error = block_average(error, blocks);
  for (double& value : error.values) value = std::sqrt(value) / blocks;
  return {.mean = block_average(read_rgb(folder / "mitsuba_ref_4x4.exr"), blocks),
          .standard_error = error,
          .dof = std::numeric_limits<double>::infinity()};
}

}  // namespace penumbra
