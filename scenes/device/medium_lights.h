// The lights that media are whose emission varies in space.
#pragma once

#include <optional>
#include <vector>

#include "scenes/device/scene_records.h"
#include "scenes/emitters.h"

namespace penumbra {

/// A light for each medium with a grid of emission that bounds or the camera name, see
/// kernels/light/medium_light.h. Its power is that of the whole grid in vacuum, also where the medium's shape
/// leaves a part of the grid out. Appends the tables; the caller sets the media's `light`.
struct MediumLight {
  int medium;  ///< index of its record
  EmitterLight light;
};
std::vector<MediumLight> medium_lights(int camera_medium, SceneRecords& records);

}  // namespace penumbra
