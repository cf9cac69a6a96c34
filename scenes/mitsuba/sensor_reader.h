// Reads <sensor> with its film, filter and sampler.
#pragma once

#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

/// Sets camera, film and sampler. Problems are reported.
void read_sensor(const Context& context, const Object& object, SceneDescription& scene);

}  // namespace penumbra::mitsuba
