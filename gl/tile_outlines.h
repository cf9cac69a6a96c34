// Outlines of the tiles that workers are rendering, as triangles in screen pixels: sharp at any zoom.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "gl/image_view.h"
#include "gl/view_model.h"

namespace penumbra {

/// The colour of a worker, of its tile's outline and in the panel: an sRGB signal in [0, 1]. Hues differ by
/// the golden ratio, so that consecutive numbers have very different colours.
inline std::array<float, 3> worker_color(std::uint32_t number) {
  const double hue = std::fmod(0.12 + 0.6180339887498949 * double(number), 1.0);
  std::array<float, 3> color{};
  for (int c = 0; c < 3; ++c) {
    const double distance = std::abs(std::fmod(hue * 6 + 4.0 * c, 6.0) - 3) - 1;  // a ramp on the hue circle
    color[std::size_t(c)] = float(1 - 0.65 * (1 - std::fmin(std::fmax(distance, 0.0), 1.0)));
  }
  return color;
}

struct OutlineVertex {
  float x, y;              ///< pixels, as in PixelRectangle
  float red, green, blue;  ///< sRGB signal
};

/// Frames along the inside of each tile's edge, `thickness` pixels wide and in the worker's colour, with a
/// dark line of one pixel inside so that they are visible on any picture. `picture` is where the whole film
/// is. Workers without a tile, and tiles outside of the film, are left out.
std::vector<OutlineVertex> outline_triangles(std::span<const WorkerView> workers,
                                             const PixelRectangle& picture, int film_width, int film_height,
                                             int thickness);

}  // namespace penumbra
