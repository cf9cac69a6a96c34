// The memory per pixel that this process needs for an image: the film, and everything that is derived from
// it.
#pragma once

#include <cstdint>

#include "kernels/host/sample_buffer.h"

namespace penumbra {

/// How many channels an image file with these layers has, without mattes; see image_of_film.
int image_channels(const FilmLayers& layers);

/// Channels of the mattes' layers in an image file, see cryptomatte.h.
constexpr int kMatteChannels = 24;

/// Bytes for each pixel of a render whose results have these layers, and a few mattes each where there are some.
struct PixelMemory {
  std::uint64_t film = 0;    ///< while it goes on and after
  std::uint64_t watch = 0;   ///< beside it while it goes on, if there are viewers: the board's newest tiles
  std::uint64_t output = 0;  ///< beside it afterwards: the image, and its file while it grows in memory

  /// At the worst time. `films_beside`: as large as the film, while it goes on: the copy of a checkpoint, the
  /// halves of a render with a target error.
  [[nodiscard]] std::uint64_t peak(bool writes_files, int films_beside = 0) const;
};
PixelMemory pixel_memory(const FilmLayers& layers);

}  // namespace penumbra
