// The memory per pixel that the scheduler needs for an image: the film and everything derived from it.
#pragma once

#include <cstdint>

#include "kernels/host/sample_buffer.h"

namespace penumbra {

/// The number of channels of an image file with these layers, without mattes; see image_of_film.
int image_channels(const FilmLayers& layers);

/// The number of channels of the mattes' layers in an image file; see cryptomatte.h.
constexpr int kMatteChannels = 24;

/// Bytes per pixel for a render whose results have these layers, with a few mattes per pixel if there are
/// any.
struct PixelMemory {
  std::uint64_t film = 0;   ///< during the render and after it
  std::uint64_t watch = 0;  ///< in addition during the render, if there are viewers: the board's newest tiles
  /// In addition after the render: the image, and its file while it is assembled in memory.
  std::uint64_t output = 0;

  /// The peak. `films_beside`: additional films during the render: the copy for a checkpoint, the halves of a
  /// render with a target error.
  [[nodiscard]] std::uint64_t peak(bool writes_files, int films_beside = 0) const;
};
PixelMemory pixel_memory(const FilmLayers& layers);

}  // namespace penumbra
