// SDF grids, and Mitsuba files of them, for tests.
#pragma once

#include <string>

#include "scenes/sdf_grid.h"
#include "scenes/volume_file.h"

namespace penumbra {

/// The distance from a sphere in the unit cube, at so many points along each edge.
inline SdfGrid ball_of_distances(int points, double radius, const glm::dvec3& center = {0.5, 0.5, 0.5}) {
  SdfGrid grid{{points, points, points}, {}};
  for (int z = 0; z < points; ++z)
    for (int y = 0; y < points; ++y)
      for (int x = 0; x < points; ++x)
        grid.values.push_back(
            float(glm::distance(glm::dvec3(x, y, z) / double(points - 1), center) - radius));
  return grid;
}

inline std::string sdf_file(const SdfGrid& grid) {
  return vol_of({grid.size[0], grid.size[1], grid.size[2], 1, grid.values});
}

}  // namespace penumbra
