// The tables of volumes: grids by which media vary, and their majorants.
#pragma once

#include <map>

#include "scenes/device/scene_records.h"
#include "scenes/grid_volume.h"

namespace penumbra {

class VolumeTables {
 public:
  /// `center`: of the scene, where the kernels' coordinates begin.
  explicit VolumeTables(const glm::dvec3& center) : center_(center) {}

  /// Appends to the tables of volumes, a grid that is there already not again. Returns the volume's index; an
  /// error where the tables would be too large for their indices, or the place has no inverse.
  Expected<int> add(const GridVolume& volume, SceneRecords& records);

 private:
  struct Values {
    int first_value, first_majorant;
  };
  glm::dvec3 center_;
  std::map<std::pair<const VolumeGrid*, bool>, Values> known_;
};

}  // namespace penumbra
