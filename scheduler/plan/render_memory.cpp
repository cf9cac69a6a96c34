#include "scheduler/plan/render_memory.h"

#include <algorithm>

#include "scheduler/plan/film_accumulator.h"
#include "scheduler/plan/tile_snapshot.h"

namespace penumbra {

// Halves, variances, features, guides and results of scheduler/denoise/nfor.cpp that exist at once.
constexpr std::uint64_t kDenoisingPlanes = 100;

int image_channels(const FilmLayers& layers) {
  int channels = 3 + 3 + 1;  // radiance, its variance and the number of samples
  for (int layer = 0; layer < FILM_LAYERS; ++layer)
    channels += layers.has(layer) ? kFilmLayers[layer].shown() : 0;
  return channels;
}

std::uint64_t PixelMemory::peak(bool writes_files, int films_beside) const {
  return film + std::max(watch + std::uint64_t(films_beside) * film, writes_files ? output : 0);
}

PixelMemory pixel_memory(const FilmLayers& layers) {
  const bool with_mattes = layers.mattes() > 0;
  const std::uint64_t image =
      std::uint64_t(image_channels(layers) + (with_mattes ? kMatteChannels : 0)) * sizeof(float);
  // The denoised image and what it is computed from.
  const std::uint64_t denoising = layers.has(LAYER_HALF_A) ? kDenoisingPlanes * sizeof(float) : 0;
  // Incompressible data fill a file as large as the image, in a buffer that doubles as it grows.
  return {.film = FilmAccumulator::bytes_per_pixel(layers) + (with_mattes ? FilmMattes::kBytesPerPixel : 0),
          .watch = TileSnapshot::bytes_per_pixel(layers.has(LAYER_DIFFERENCE)),
          .output = image + std::max(2 * image, denoising > 0 ? image + denoising : 0)};
}

}  // namespace penumbra
