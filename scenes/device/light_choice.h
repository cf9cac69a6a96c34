// How lights are chosen: by the hierarchy of them, or by the table where they are as one.
#pragma once

#include <span>

#include "kernels/host/error.h"
#include "kernels/scene_types.h"
#include "scenes/device/intersector.h"
#include "scenes/device/light_bounds.h"
#include "scenes/device/scene_records.h"
#include "scenes/integrators.h"

namespace penumbra {

/// Fills in the hierarchy of lights of a header with FEATURE_LIGHT_TREE, whose other tables are complete;
/// `bounds` of each light. Where the settings leave the choice open and the lights are as one, takes it back:
/// the header and the probabilities of the lights are then those of a choice by the table.
/// `scene_radius`: of a sphere about all shapes. `hierarchy`: of the records. Errors: those of building a
/// hierarchy of the shapes.
Expected<void> add_light_tree(std::span<const LightBounds> bounds, const IntegratorSettings& integrator,
                              double scene_radius, SceneHeader& header, SceneRecords& records,
                              BorrowedHierarchy& hierarchy);

}  // namespace penumbra
