// Outlines of the tiles that workers are rendering, as triangles in screen pixels: sharp at any zoom.
#pragma once

#include <span>
#include <vector>

#include "gl/image_view.h"
#include "gl/view_model.h"

namespace penumbra {

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
