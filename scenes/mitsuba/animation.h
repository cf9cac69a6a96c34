// Animated transforms. The renderer has no motion, so each animation is evaluated at the time when the
// shutter opens.
#pragma once

#include "scenes/mitsuba/plugin.h"

namespace penumbra::mitsuba {

/// The transform at a time between two keys. The polar decomposition of each key (Shoemake and Duff 1992,
/// "Matrix animation and polar decomposition") is interpolated: translations and stretches linearly,
/// rotations by spherical linear interpolation. Before the first key it is the first, after the last key the
/// last.
glm::dmat4 transform_at(const AnimationValue& animation, double time);

/// The times between which a sensor sees the scene, `open` at most `close`.
struct Shutter {
  double open = 0.0, close = 0.0;
};
/// That of the first sensor; none: both are 0.
Shutter shutter_of(const Context& context);

/// Replaces every animation of the scene by its transform at the sensor's `shutter_open`, with one warning
/// for all. The animation of an instance may be named `animation`.
void freeze_animations(const Context& context, const Object* sensor);

}  // namespace penumbra::mitsuba
