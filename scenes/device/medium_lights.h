// The lights that emitting media are.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "scenes/device/scene_records.h"
#include "scenes/emitters.h"
#include "scenes/scene_bounds.h"

namespace penumbra {

/// The boxes of the shapes that contain each medium, given by its record, relative to the scene's centre.
using MediumBoxes = std::map<int, std::vector<SceneBounds>>;

/// A light for each emitting medium that bounds or the camera name, see kernels/light/medium_light.h.
/// Emission without a grid needs boxes, which get one of up to 16^3 cells. The power is that of the whole
/// grid in vacuum, also where the medium's shape leaves a part of the grid out. Appends the tables; the
/// caller sets the media's `light`.
struct MediumLight {
  int medium;  ///< index of its record
  EmitterLight light;
};
std::vector<MediumLight> medium_lights(int camera_medium, const MediumBoxes& boxes, SceneRecords& records);

}  // namespace penumbra
