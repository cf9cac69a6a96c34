#include "scheduler/image/display_image.h"

#include <algorithm>
#include <cmath>

#include "scheduler/image/picture.h"

namespace penumbra {

Expected<Image> display_image(const Image& image) {
  const auto beauty = image.beauty_channels();
  if (!beauty) return fail("there are no channels R, G, B");
  LayerPicture picture;
  if (!is_display_image(image)) {
    auto made = picture_of(image);
    if (!made) return std::unexpected(made.error());
    picture = std::move(*made);
  }
  const std::size_t channels = picture.has_alpha ? 4 : 3;
  Image result;
  result.data = image.data;
  result.display = image.display;
  result.channels = {"R", "G", "B"};
  result.metadata = {{"oiio:ColorSpace", "sRGB"}};
  result.values.reserve(3 * image.pixels());
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = image.values[pixel * image.channels.size() + (*beauty)[c]];
      int byte = 0;
      if (picture.pixels.empty()) {
        byte = int(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
      } else {
        // OpenImageIO multiplies by alpha with integers.
        const std::uint8_t* bytes = &picture.pixels[pixel * channels];
        byte = bytes[c] * (picture.has_alpha ? bytes[3] : 255) / 255;
      }
      result.values.push_back(std::isfinite(value) ? float(byte) / 255.0f : value);
    }
  }
  return result;
}

}  // namespace penumbra
