#include "scheduler/record/film_image.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "scheduler/record/cryptomatte.h"

namespace penumbra {
namespace {

// Of the planes from kRadiancePlanes on; the last is the quotient of two.
constexpr const char* kLayerChannels[] = {
    "albedo.R",   "albedo.G",   "albedo.B",   "normal.X",     "normal.Y",     "normal.Z",     "depth.Z",
    "analytic.R", "analytic.G", "analytic.B", "difference.R", "difference.G", "difference.B", "visibility.Y"};
static_assert(std::size(kLayerChannels) == kSeen + 1 - kRadiancePlanes);

}  // namespace

Image image_of_film(const FilmAccumulator& film, int film_width, int film_height, const MatteNames* mattes) {
  Image image;
  image.chromaticities = kRec709;
  image.data = {film.x(), film.y(), film.width(), film.height()};
  image.display = {0, 0, film_width, film_height};
  image.channels = {"R", "G", "B", "variance.R", "variance.G", "variance.B"};
  const int coverage = coverage_plane_of(film.planes());
  const bool visibility = layer_planes_of(film.planes()) > kSeen;
  const int layers_end = visibility ? int(kSeen) : layer_planes_of(film.planes());
  if (coverage >= 0) image.channels.insert(image.channels.begin() + 3, "A");
  for (int plane = kRadiancePlanes; plane < layers_end + (visibility ? 1 : 0); ++plane)
    image.channels.emplace_back(kLayerChannels[plane - kRadiancePlanes]);
  image.channels.emplace_back("samples.Y");
  std::optional<CryptomattePixels> cryptomatte;
  if (mattes != nullptr) {
    const std::vector<std::string> channels = cryptomatte_channels();
    image.channels.insert(image.channels.end(), channels.begin(), channels.end());
    image.exact_channels = channels.size();
    cryptomatte.emplace(*mattes);
  }
  image.values.reserve(image.pixels() * image.channels.size());
  const auto append = [&](const double(&values)[3]) {
    for (const double value : values) image.values.push_back(float(value));
  };
  for (int y = film.y(); y < film.y() + film.height(); ++y) {
    for (int x = film.x(); x < film.x() + film.width(); ++x) {
      const PixelStatistics& pixel = film.at(x, y);
      append(pixel.mean);
      if (coverage >= 0) image.values.push_back(float(film.layer(x, y, coverage)));
      for (const double m2 : pixel.m2) image.values.push_back(float(variance_of_mean(pixel.count, m2)));
      for (int plane = kRadiancePlanes; plane < layers_end; ++plane)
        image.values.push_back(float(film.layer(x, y, plane)));
      if (visibility) image.values.push_back(float(film.visibility(x, y)));
      image.values.push_back(float(pixel.count));
      if (cryptomatte) cryptomatte->append(film, x, y, image.values);
    }
  }
  return image;
}

SampleRange sample_range(const FilmAccumulator& film) {
  if (film.width() == 0 || film.height() == 0) return {};
  SampleRange range{.least = film.at(film.x(), film.y()).count};
  for (int y = film.y(); y < film.y() + film.height(); ++y) {
    for (int x = film.x(); x < film.x() + film.width(); ++x) {
      const std::uint64_t count = film.at(x, y).count;
      range.least = std::min(range.least, count);
      range.most = std::max(range.most, count);
      range.total += count;
    }
  }
  return range;
}

std::uint64_t pixels_of_infinite_variance(const FilmAccumulator& film) {
  std::uint64_t pixels = 0;
  for (int y = film.y(); y < film.y() + film.height(); ++y) {
    for (int x = film.x(); x < film.x() + film.width(); ++x) {
      const PixelStatistics& pixel = film.at(x, y);
      const bool infinite = std::ranges::any_of(
          pixel.m2, [&](double m2) { return !std::isfinite(float(variance_of_mean(pixel.count, m2))); });
      pixels += infinite ? 1 : 0;
    }
  }
  return pixels;
}

double variance_of_mean(std::uint64_t count, double m2) {
  return count < 2 ? 0.0 : m2 / (double(count) * double(count - 1));
}

}  // namespace penumbra
