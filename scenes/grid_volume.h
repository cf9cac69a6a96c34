// Numbers on a grid that fills a box, by which what a medium is varies over it.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

namespace penumbra {

/// Numbers at the centres of equal cells, x fastest; of each cell all channels.
struct VolumeGrid {
  int nx = 0, ny = 0, nz = 0;
  int channels = 1;           ///< 1 or 3
  std::vector<float> values;  ///< nx * ny * nz * channels, finite and at least 0
};

/// A grid placed in space. Between centres it is interpolated, beyond the outermost ones constant.
struct GridVolume {
  std::shared_ptr<const VolumeGrid> grid;  ///< never null
  glm::dmat4 to_world{1.0};                ///< of the unit cube, which the grid fills; it has an inverse
  bool nearest = false;                    ///< each cell has its value throughout instead
};

}  // namespace penumbra
