// What a pinhole camera sees of flat pieces, by the outline of all of them on the film, pixel by pixel.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/device/filter_mass.h"

namespace penumbra {

/// In pixels from the film's upper left corner, x to the right and y down. What it is an edge of is at
/// smaller x where `to` is below `from`, else at larger x.
struct FilmEdge {
  glm::dvec2 from, to;
};

/// The edges of triangles between the camera's clipping planes, but for those that two of them share (their
/// ends the same to the bit). The camera sees the triangles counter-clockwise. Time: n log n.
std::vector<FilmEdge> outline_on_film(const Camera& camera, const FilmParameters& film,
                                      std::span<const std::array<vec3, 3>> triangles);

/// An outline within the reach of a pixel's filter.
struct OutlinePixel {
  int x, y;
  /// In filter radii about the pixel's centre, within [-1, 1]. What is right of the reach is at its border:
  /// how often edges wind about a point follows from those to its right.
  std::vector<FilmEdge> edges;
  std::vector<FilmEdge> inside;  ///< those that are in reach, as they are

  /// How many times the edges wind about a point in reach: 1 within a simple outline, 0 outside.
  [[nodiscard]] int winding(glm::dvec2 p) const;
  /// The share of the pixel by its filter that is within the outline.
  [[nodiscard]] double share(const FilterMass& filter) const;
};

/// Those pixels of the film whose filters an edge crosses, row by row, in the order of x; but for pixels with
/// more than 64 edges.
std::vector<OutlinePixel> outline_pixels(std::span<const FilmEdge> edges, const FilmParameters& film);

}  // namespace penumbra
