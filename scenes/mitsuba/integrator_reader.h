// <integrator>.
#pragma once

#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

/// Sets the integrator; what is wrong is reported. Of those that only wrap another, the other counts. For
/// Mitsuba's other ways to compute what `path` computes, `path` stands in, with a warning.
/// Whether it, or the one inside it, follows light through media. `path` and its like pass through their
/// boundaries and see nothing of them, in every version of Mitsuba.
bool follows_media(const Context& context, const Object& integrator);

void read_integrator(const Context& context, const Object& object, SceneDescription& scene);

}  // namespace penumbra::mitsuba
