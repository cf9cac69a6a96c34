// Numbers on a grid that fills a box. They make the properties of a medium vary in space.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

namespace penumbra {

/// Numbers at the centres of equal cells, x fastest. All channels of a cell are adjacent.
struct VolumeGrid {
  int nx = 0, ny = 0, nz = 0;
  int channels = 1;           ///< 1 or 3
  std::vector<float> values;  ///< nx * ny * nz * channels, finite and at least 0
};

/// A grid placed in space. Values are interpolated between cell centres. Beyond the outermost centres they
/// are constant, or, with `fades`, interpolated towards cells of value 0 around the grid.
struct GridVolume {
  std::shared_ptr<const VolumeGrid> grid;  ///< never null
  glm::dmat4 to_world{1.0};  ///< the transform of the unit cube, which the grid fills; invertible
  bool nearest = false;      ///< no interpolation: the value is constant in each cell
  bool fades = false;        ///< only without `nearest`
};

}  // namespace penumbra
