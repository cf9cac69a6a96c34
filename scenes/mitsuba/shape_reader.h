// <shape> objects, with their materials.
#pragma once

#include "scenes/file_access.h"
#include "scenes/mitsuba/material_reader.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

/// Reads `object` into `scene.shapes`; what is wrong is reported. A mesh without a triangle that has area is
/// left out, with a warning.
void read_shape(const Context& context, const Object& object, const FileAccess& files,
                MaterialReader& materials, SceneDescription& scene);

}  // namespace penumbra::mitsuba
