// <emitter> objects: those of a shape, and those of the scene.
#pragma once

#include "scenes/mitsuba/plugin.h"
#include "scenes/mitsuba/sky_reader.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

/// Makes the shape, whose geometry is known, shine as <emitter type="area"> says; any other type is reported.
void read_area_light(const Context& context, const Object& emitter, Shape& shape);

/// Reads a light that is no shape into `scene.emitters`; what is wrong is reported. False for one that needs
/// a placeholder.
bool read_emitter(const Context& context, const Object& object, SceneDescription& scene, SkyReader& sky);

}  // namespace penumbra::mitsuba
