// Cells of triangles from which all of every light is seen, found once while the scene is built: see
// kernels/light/lit_cells.h.
#pragma once

#include "scenes/device/scene_records.h"

namespace penumbra {

/// Finds them on the sides that the camera sees, down to a few pixels, where all lights are polygons, and
/// fills their tables, with the feature bit if there are any. The scene is whole otherwise. The work is
/// bounded, whatever the scene.
void add_lit_cells(SceneHeader& header, SceneRecords& records);

}  // namespace penumbra
