// Reads <sensor> with its film, filter and sampler.
#pragma once

#include <span>

#include "scenes/mitsuba/plugin.h"
#include "scenes/motion/keyed_transform.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

/// Sets camera, film and sampler. Problems are reported. `keys`: of its to_world, if that moves.
void read_sensor(const Context& context, const Object& object, std::span<const TransformKey> keys,
                 SceneDescription& scene);

}  // namespace penumbra::mitsuba
