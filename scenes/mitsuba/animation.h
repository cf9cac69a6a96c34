// Animated transforms: nothing moves in Penumbra, so each is what it is when the shutter opens.
#pragma once

#include "scenes/mitsuba/plugin.h"

namespace penumbra::mitsuba {

/// Between keys: translations and stretches are linear and rotations spherically linear, of the polar
/// decomposition of each (Shoemake and Duff 1992, "Matrix animation and polar decomposition"). Before the
/// first key it is that, after the last that.
glm::dmat4 transform_at(const AnimationValue& animation, double time);

/// Makes a transform of every animation of the scene, that at the `shutter_open` of the sensor, with one
/// warning. That of an instance may be named `animation`.
void freeze_animations(const Context& context, const Object* sensor);

}  // namespace penumbra::mitsuba
