// Decides how lights are chosen: by the hierarchy of lights, or by the power table.
#pragma once

#include <span>

#include "kernels/host/error.h"
#include "kernels/scene_types.h"
#include "scenes/device/intersector.h"
#include "scenes/device/light_bounds.h"
#include "scenes/device/scene_records.h"
#include "scenes/integrators.h"

namespace penumbra {

/// Builds the hierarchy of lights for a header with FEATURE_LIGHT_TREE. All other tables must be complete;
/// `bounds` has one entry per light. If the settings leave the choice open and all lights are close together,
/// like the triangles of one light, the feature is removed again, and the header and the lights'
/// probabilities are those of the table. `scene_radius` is the radius of a bounding sphere of all shapes.
/// `hierarchy` is the acceleration structure of the records. Errors: those of building that acceleration
/// structure.
Expected<void> add_light_tree(std::span<const LightBounds> bounds, const IntegratorSettings& integrator,
                              double scene_radius, SceneHeader& header, SceneRecords& records,
                              TemporaryHierarchy& hierarchy);

}  // namespace penumbra
