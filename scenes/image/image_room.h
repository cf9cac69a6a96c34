// What readers of image files share: room for texels, and messages in one line.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <new>
#include <string>

#include "kernels/host/chromaticities.h"
#include "kernels/host/error.h"
#include "scenes/image/image_module.h"

namespace penumbra {

/// A library's message in one line.
inline std::string one_line(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text.empty() ? "unknown error" : text;
}

inline bool are_rec709(const Chromaticities& said) {
  constexpr float kSame = 1e-4f;  // files have four decimals
  return std::ranges::equal(said, kRec709, [](float a, float b) { return std::abs(a - b) <= kSame; });
}

/// Error: the image's size, number of channels and type need more than `most_bytes`.
inline Expected<void> check_room(const ImageContents& image, std::size_t most_bytes) {
  const double bytes = double(image.width) * double(image.height) * double(image.channels.size()) *
                       double(size_of(image.type));
  if (bytes <= double(most_bytes)) return {};
  return fail(
      fmt::format("has {} x {} texels of {} channels, {:.1f} GiB; {:.0f} GiB are the most that a texture may "
                  "take: scale it down",
                  image.width, image.height, image.channels.size(), bytes / double(1 << 30),
                  double(most_bytes) / double(1 << 30)));
}

/// Makes room for the texels. Errors: more than `most_bytes`, or than there is memory.
inline Expected<void> make_room(ImageContents& image, std::size_t most_bytes) {
  if (auto checked = check_room(image, most_bytes); !checked) return checked;
  try {
    image.bytes.resize(std::size_t(image.width) * std::size_t(image.height) * image.channels.size() *
                       size_of(image.type));
  } catch (const std::bad_alloc&) {
    return fail("has more pixels than there is memory for");
  }
  return {};
}

}  // namespace penumbra
