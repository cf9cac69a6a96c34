// Builds a scene description from an object tree. Here the plugins of Mitsuba get their meaning.
#pragma once

#include "scenes/file_access.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

/// Builds the scene. Problems are reported.
SceneDescription build_scene(const Context& context, const FileAccess& files);

}  // namespace penumbra::mitsuba
