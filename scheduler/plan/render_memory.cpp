#include "scheduler/plan/render_memory.h"

#include <algorithm>

#include "scheduler/plan/film_accumulator.h"
#include "scheduler/watch/tile_snapshot.h"

namespace penumbra {

int image_channels(int planes) {
  // Radiance, its variance and the number of samples; of the polygon lights' two last planes the quotient.
  return planes + 1 - (layer_planes_of(planes) > kSeen ? 1 : 0);
}

std::uint64_t PixelMemory::peak(bool writes_files, int films_beside) const {
  return film + std::max(watch + std::uint64_t(films_beside) * film, writes_files ? output : 0);
}

PixelMemory pixel_memory(int planes, bool with_mattes) {
  const std::uint64_t image =
      std::uint64_t(image_channels(planes) + (with_mattes ? kMatteChannels : 0)) * sizeof(float);
  // What does not compress fills a file as large as the image, in a buffer that doubles as it grows.
  return {.film = FilmAccumulator::bytes_per_pixel(planes) + (with_mattes ? FilmMattes::kBytesPerPixel : 0),
          .watch = TileSnapshot::bytes_per_pixel(planes > kDifferenceB),
          .output = image + 2 * image};
}

}  // namespace penumbra
