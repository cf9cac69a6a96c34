// The frames of spot lights and projectors, and what moves of emitters that are not shapes.
#pragma once

#include <functional>

#include "scenes/emitters.h"

namespace penumbra {

/// The frame of a light: orthonormal axes with the transform's z axis; mirrored if the transform mirrors.
Beam beam_frame(const glm::dmat4& to_world);

/// Sets the place and the axes of the emitter's light, see LightState; what it has none of is left as it is.
void set_light_state(const Emitter& emitter, const std::function<vec3(const glm::dvec3&)>& local,
                     LightState& state);

}  // namespace penumbra
