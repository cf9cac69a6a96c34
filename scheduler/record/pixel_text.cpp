#include "scheduler/record/pixel_text.h"

#include <fmt/format.h>

#include <cmath>

#include "kernels/host/text.h"
#include "scheduler/record/film_image.h"

namespace penumbra {
namespace {

std::string decimal_row(const char* name, const double (&v)[3]) {
  return fmt::format("{:<16}{:>17.9g}{:>17.9g}{:>17.9g}\n", name, v[0], v[1], v[2]);
}

}  // namespace

std::string pixel_text(const FilmAccumulator& film, int x, int y) {
  const PixelStatistics& pixel = film.at(x, y);
  double standard_error[3];
  for (int c = 0; c < 3; ++c) standard_error[c] = std::sqrt(variance_of_mean(pixel.count, pixel.m2[c]));
  std::string text = fmt::format("pixel {},{}  {}\n", x, y, counted(pixel.count, "sample"));
  text += decimal_row("radiance", pixel.mean);
  text += fmt::format("{:<16}{:>17a}{:>17a}{:>17a}\n", "  exactly", float(pixel.mean[0]),
                      float(pixel.mean[1]), float(pixel.mean[2]));
  text += decimal_row("standard error", standard_error);
  for (int layer = 0; layer < FILM_LAYERS; ++layer) {
    const FilmLayerInfo& info = kFilmLayers[layer];
    if (!film.layers().has(layer) || info.channels.empty()) continue;
    text += fmt::format("{:<16}", layer == LAYER_COVERAGE ? "alpha" : info.name);
    for (int plane = 0; plane < info.planes; ++plane)
      text += fmt::format("{:>17.9g}",
                          layer == LAYER_SHADOWED ? film.visibility(x, y) : film.layer(x, y, layer, plane));
    text += '\n';
  }
  return text;
}

}  // namespace penumbra
