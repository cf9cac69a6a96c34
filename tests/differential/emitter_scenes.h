// Spot lights, directional lights, projectors, and lights with textures on every shape.
#pragma once

#include <vector>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

std::vector<SceneText> emitter_scenes();

}  // namespace penumbra::differential
