// Outlines of the tiles that workers have in hand, as triangles in pixels of the screen: crisp at any zoom.
#pragma once

#include <span>
#include <vector>

#include "gl/view_model.h"

namespace penumbra {

/// Pixels from the upper left corner of what is drawn on; y grows downwards.
struct PixelRectangle {
  int x = 0, y = 0, width = 0, height = 0;
  bool operator==(const PixelRectangle&) const = default;
};

/// The largest rectangle of the film's aspect within `area`, in its middle, at least a pixel in each
/// direction. Empty if the area or the film is.
PixelRectangle letterboxed(const PixelRectangle& area, int film_width, int film_height);

struct OutlineVertex {
  float x, y;              ///< pixels, as in PixelRectangle
  float red, green, blue;  ///< sRGB signal
};

/// Frames along the inside of each tile's edge, `thickness` pixels wide and in the worker's colour, with a
/// dark line of a pixel inside so that they show on any picture. `picture` is where the whole film is.
/// Workers without a tile are left out, as are tiles that are not within the film.
std::vector<OutlineVertex> outline_triangles(std::span<const WorkerView> workers,
                                             const PixelRectangle& picture, int film_width, int film_height,
                                             int thickness);

}  // namespace penumbra
