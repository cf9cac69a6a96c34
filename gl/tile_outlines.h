// Outlines of the tiles that workers are rendering, as triangles in screen pixels: sharp at any zoom.
#pragma once

#include <span>
#include <vector>

#include "gl/view_model.h"

namespace penumbra {

/// Pixels from the upper left corner of the target; y grows downwards.
struct PixelRectangle {
  int x = 0, y = 0, width = 0, height = 0;
  bool operator==(const PixelRectangle&) const = default;
};

/// The largest rectangle with the film's aspect ratio in the middle of `area`, at least one pixel in each
/// direction. Empty if the area or the film is empty.
PixelRectangle letterboxed(const PixelRectangle& area, int film_width, int film_height);

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
