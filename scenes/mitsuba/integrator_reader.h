// <integrator>.
#pragma once

#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

/// Sets the integrator; what is wrong is reported. Of those that only wrap another, the other counts. For
/// Mitsuba's other ways to compute what `path` computes, `path` stands in, with a warning; or `volpath`, if
/// the scene has media and they see them. `path` and its like see nothing of media, in every version of
/// Mitsuba.
void read_integrator(const Context& context, const Object& object, SceneDescription& scene);

}  // namespace penumbra::mitsuba
