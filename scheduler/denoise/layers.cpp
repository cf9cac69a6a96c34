#include "scheduler/denoise/layers.h"

#include <fmt/format.h>

#include <cstddef>

#include "scenes/names.h"

namespace penumbra {

std::vector<std::size_t> find_layer(const Image& image, std::initializer_list<std::string_view> layers,
                                    std::initializer_list<std::string_view> letters) {
  for (const std::string_view layer : layers)
    for (const std::string_view of_channels : letters) {
      std::vector<std::size_t> found;
      for (const char letter : of_channels) {
        const std::string ending = to_lower_case(fmt::format("{}.{}", layer, letter));
        for (std::size_t k = 0; k < image.channels.size(); ++k) {
          const std::string name = to_lower_case(image.channels[k]);
          if (name == ending || name.ends_with("." + ending)) {
            found.push_back(k);
            break;
          }
        }
      }
      if (found.size() == of_channels.size()) return found;
    }
  return {};
}

Planes planes_of(const Image& image, std::span<const std::size_t> channels) {
  Planes planes(image.data.width, image.data.height, int(channels.size()));
  for (std::size_t k = 0; k < channels.size(); ++k)
    for (std::size_t i = 0; i < image.pixels(); ++i)
      planes.plane(int(k))[i] = image.values[i * image.channels.size() + channels[k]];
  return planes;
}

Planes planes_of_layer(const Image& image, std::span<const std::size_t> channels, int count) {
  return channels.empty() ? Planes(image.data.width, image.data.height, count) : planes_of(image, channels);
}

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

void set_channels(Image& image, std::span<const std::size_t> channels, const Planes& values) {
  for (std::size_t k = 0; k < channels.size(); ++k)
    for (std::size_t i = 0; i < image.pixels(); ++i)
      image.values[i * image.channels.size() + channels[k]] = values.plane(int(k))[i];
}

}  // namespace penumbra
