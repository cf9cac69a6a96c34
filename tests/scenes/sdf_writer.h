// Grids of distances, and Mitsuba's files of them, for tests.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>

#include "scenes/sdf_grid.h"

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
  std::string file = "VOL\3";
  const auto put = [&](const auto& value) {
    file.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  put(std::int32_t(1));
  for (const int size : grid.size) put(std::int32_t(size));
  put(std::int32_t(1));
  for (const float corner : {0.0f, 0.0f, 0.0f, 1.0f, 1.0f, 1.0f}) put(corner);
  for (const float value : grid.values) put(value);
  return file;
}

}  // namespace penumbra
