#include "scheduler/cli/pixel_text.h"

#include <fmt/format.h>

#include <cmath>

#include "kernels/host/words.h"
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
  const auto layer = [&](const char* name, int plane) {
    text += decimal_row(name,
                        {film.layer(x, y, plane), film.layer(x, y, plane + 1), film.layer(x, y, plane + 2)});
  };
  const auto value = [&](const char* name, double number) {
    text += fmt::format("{:<16}{:>17.9g}\n", name, number);
  };
  const int coverage = coverage_plane_of(film.planes()), layers = layer_planes_of(film.planes());
  if (coverage >= 0) value("alpha", film.layer(x, y, coverage));
  if (layers >= kFeaturePlanes) {
    layer("albedo", kAlbedoR);
    layer("normal", kNormalX);
    value("depth", film.layer(x, y, kDepth));
  }
  if (layers >= kSampleBufferPlanes) {
    layer("analytic", kAnalyticR);
    layer("difference", kDifferenceR);
    value("visibility", film.visibility(x, y));
  }
  return text;
}

}  // namespace penumbra
