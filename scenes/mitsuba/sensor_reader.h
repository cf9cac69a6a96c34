// <sensor>, with its film, filter and sampler, and <integrator>.
#pragma once

#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

/// Sets camera, film and sampler; what is wrong is reported.
void read_sensor(const Context& context, const Object& object, SceneDescription& scene);

/// Sets the integrator; what is wrong is reported. Of those that only wrap another, the other counts.
void read_integrator(const Context& context, const Object& object, SceneDescription& scene);

}  // namespace penumbra::mitsuba
