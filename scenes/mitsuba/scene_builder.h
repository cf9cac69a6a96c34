// From an object tree to a scene description: what Mitsuba's plugins mean.
#pragma once

#include "scenes/file_access.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

/// Builds the scene; what is wrong is reported.
SceneDescription build_scene(const Context& context, const FileAccess& files);

}  // namespace penumbra::mitsuba
