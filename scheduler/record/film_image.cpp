#include "scheduler/record/film_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/record/cryptomatte.h"

namespace penumbra {
namespace {

/// Adds the channels of a layer's planes; none if the layer is not shown by itself.
void add_channels(const FilmLayerInfo& layer, std::vector<std::string>& channels) {
  for (int plane = 0; plane < layer.shown(); ++plane)
    channels.push_back(layer.name.empty() ? std::string(layer.channel(plane))
                                          : fmt::format("{}.{}", layer.name, layer.channel(plane)));
}

/// What an image shows of a layer.
double shown_value(const FilmAccumulator& film, int x, int y, int layer, int plane) {
  const double value = film.layer(x, y, layer, plane);
  const auto share = [&] { return film.layer(x, y, LAYER_HALF_SHARE); };
  const auto mean = [value](double of_samples) { return of_samples > 0 ? value / of_samples : 0; };
  switch (layer) {
    case LAYER_SHADOWED:
      return film.visibility(x, y);
    case LAYER_ALBEDO_VARIANCE:
    case LAYER_NORMAL_VARIANCE:
    case LAYER_DEPTH_VARIANCE:
      return variance_of_mean(film.at(x, y).count, value);
    case LAYER_HALF_A:
      return mean(share());
    case LAYER_HALF_B:
      return mean(1 - share());
    default:
      return value;
  }
}

}  // namespace

Image image_of_film(const FilmAccumulator& film, int film_width, int film_height, const MatteNames* mattes) {
  Image image;
  image.chromaticities = kRec709;
  image.data = {film.x(), film.y(), film.width(), film.height()};
  image.display = {0, 0, film_width, film_height};
  image.channels = {"R", "G", "B", "variance.R", "variance.G", "variance.B"};
  const FilmLayers& layers = film.layers();
  const bool has_alpha = layers.has(LAYER_COVERAGE);
  if (has_alpha) image.channels.insert(image.channels.begin() + 3, "A");
  for (int layer = 0; layer < FILM_LAYERS; ++layer)
    if (layers.has(layer) && layer != LAYER_COVERAGE) add_channels(kFilmLayers[layer], image.channels);
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
      if (has_alpha) image.values.push_back(float(film.layer(x, y, LAYER_COVERAGE)));
      for (const double m2 : pixel.m2) image.values.push_back(float(variance_of_mean(pixel.count, m2)));
      for (int layer = 0; layer < FILM_LAYERS; ++layer)
        for (int plane = 0; layers.has(layer) && plane < kFilmLayers[layer].shown(); ++plane)
          if (layer != LAYER_COVERAGE) image.values.push_back(float(shown_value(film, x, y, layer, plane)));
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
