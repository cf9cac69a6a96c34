#include "scheduler/web/film_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scheduler/image/image_files.h"
#include "scheduler/image/metrics/color_space.h"
#include "scheduler/image/picture.h"
#include "scheduler/image/tone_map.h"

namespace penumbra {
namespace {

constexpr double kOpaque = 255;

/// Sums of linear light over the pixels of a larger image.
class ReducedPicture {
 public:
  ReducedPicture(int width, int height, int largest_side)
      : from_width_(std::max(1, width)), from_height_(std::max(1, height)) {
    const double scale = std::min(1.0, double(largest_side) / std::max(from_width_, from_height_));
    width_ = std::max(1, int(std::lround(from_width_ * scale)));
    height_ = std::max(1, int(std::lround(from_height_ * scale)));
    sums_.resize(std::size_t(width_) * std::size_t(height_));
  }

  /// Adds a pixel; x and y are relative to the corner of the larger image.
  void add(int x, int y, const std::array<double, 3>& linear, double alpha) {
    if (x < 0 || y < 0 || x >= from_width_ || y >= from_height_) return;
    Sum& sum = sums_[std::size_t(std::int64_t(y) * height_ / from_height_) * std::size_t(width_) +
                     std::size_t(std::int64_t(x) * width_ / from_width_)];
    for (std::size_t c = 0; c < 3; ++c)
      if (std::isfinite(linear[c])) sum.light[c] += alpha * std::clamp(linear[c], 0.0, 1.0);
    sum.alpha += alpha;
    ++sum.pixels;
  }

  [[nodiscard]] Expected<std::string> png() const {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(4 * sums_.size());
    for (const Sum& sum : sums_) {
      for (const double light : sum.light)
        bytes.push_back(sum.alpha > 0 ? display_byte(float(light / sum.alpha)) : 0);
      bytes.push_back(sum.pixels > 0 ? std::uint8_t(std::lround(kOpaque * sum.alpha / sum.pixels)) : 0);
    }
    const auto encoded = encode_png_bytes(width_, height_, bytes, true);
    if (!encoded) return std::unexpected(encoded.error());
    return std::string(encoded->begin(), encoded->end());
  }

 private:
  struct Sum {
    std::array<double, 3> light{};
    double alpha = 0;
    int pixels = 0;
  };
  int from_width_, from_height_, width_ = 1, height_ = 1;
  std::vector<Sum> sums_;
};

}  // namespace

Expected<std::string> picture_of_film(const LiveFilm& film, int largest_side) {
  ReducedPicture picture(film.width, film.height, largest_side);
  for (const auto& tile : film.tiles)
    for (int y = 0; y < tile->height; ++y)
      for (int x = 0; x < tile->width; ++x) {
        const float* radiance =
            &tile->radiance[3 * (std::size_t(y) * std::size_t(tile->width) + std::size_t(x))];
        picture.add(tile->x + x - film.x, tile->y + y - film.y, {radiance[0], radiance[1], radiance[2]}, 1);
      }
  return picture.png();
}

Expected<std::string> picture_of_image(const Image& image, int largest_side) {
  const auto shown = picture_of(image);
  if (!shown) return std::unexpected(shown.error());
  static const auto linear = [] {
    std::array<double, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = linear_from_srgb(double(i) / kOpaque);
    return table;
  }();
  ReducedPicture picture(image.data.width, image.data.height, largest_side);
  const std::uint8_t* pixel = shown->pixels.data();
  for (int y = 0; y < image.data.height; ++y)
    for (int x = 0; x < image.data.width; ++x, pixel += shown->has_alpha ? 4 : 3)
      picture.add(x, y, {linear[pixel[0]], linear[pixel[1]], linear[pixel[2]]},
                  shown->has_alpha ? pixel[3] / kOpaque : 1);
  return picture.png();
}

}  // namespace penumbra
