// The outline of planar pieces on the film of a pinhole camera, pixel by pixel.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/device/filter_table.h"

namespace penumbra {

/// An edge of an outline, in pixels from the film's upper left corner, x to the right and y down. The
/// outlined region lies at smaller x if `to` is below `from` (has the larger y), else at larger x.
struct FilmEdge {
  glm::dvec2 from, to;
};

/// The outline edges of triangles, clipped to the camera's clipping planes. Edges that two triangles share
/// (with bitwise identical ends) are left out. The camera must see the triangles counter-clockwise. Time: O(n
/// log n).
std::vector<FilmEdge> outline_on_film(const Camera& camera, const FilmParameters& film,
                                      std::span<const std::array<vec3, 3>> triangles);

/// The part of an outline within the support of a pixel's filter.
struct OutlinePixel {
  int x, y;
  /// Edges relative to the pixel's centre in filter radii, within [-1, 1]. Edges to the right of the support
  /// are moved to its border, because the winding number of a point depends on the edges to its right.
  std::vector<FilmEdge> edges;
  std::vector<FilmEdge> inside;  ///< the edges inside the support, unchanged

  /// The winding number of a point in the support: 1 inside a simple outline, 0 outside.
  [[nodiscard]] int winding(glm::dvec2 p) const;
  /// The fraction of the pixel, weighted by its filter, that lies inside the outline.
  [[nodiscard]] double share(const FilterMass& filter) const;
};

/// The pixels of the film whose filter support an edge crosses, row by row and by ascending x. Pixels with
/// more than 64 edges are left out.
std::vector<OutlinePixel> outline_pixels(std::span<const FilmEdge> edges, const FilmParameters& film);

}  // namespace penumbra
