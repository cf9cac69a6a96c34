// The tables of volumes: grids by which media vary in space, and their majorants.
#pragma once

#include <map>

#include "scenes/device/scene_records.h"
#include "scenes/grid_volume.h"

namespace penumbra {

class VolumeTables {
 public:
  /// `center`: the centre of the scene, which is the origin of the kernels' coordinates.
  explicit VolumeTables(const glm::dvec3& center) : center_(center) {}

  /// Adds a volume to the tables and returns its index. A grid that is already in the tables is not stored
  /// again. Errors: tables too large for their indices; a transform that has no inverse.
  Expected<int> add(const GridVolume& volume, SceneRecords& records);

 private:
  struct Values {
    int first_value, first_majorant;
  };
  glm::dvec3 center_;
  std::map<std::pair<const VolumeGrid*, bool>, Values> known_;
};

}  // namespace penumbra
