// Reads <emitter> objects of shapes and of the scene.
#pragma once

#include "scenes/mitsuba/plugin.h"
#include "scenes/mitsuba/sky_reader.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

/// Makes the shape, whose geometry is already known, an area light as given by <emitter type="area">. Any
/// other type is reported.
void read_area_light(const Context& context, const Object& emitter, Shape& shape);

/// Reads an emitter that is not a shape into `scene.emitters`. Problems are reported. Returns false if the
/// emitter needs a placeholder.
bool read_emitter(const Context& context, const Object& object, SceneDescription& scene, SkyReader& sky);

}  // namespace penumbra::mitsuba
