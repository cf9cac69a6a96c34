// Random scenes by seed: a floor, shapes, lights and settings. They contain nothing that two correct
// renderers may treat differently; random_scene.cpp says where and why.
#pragma once

#include <cstdint>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

SceneText random_scene(std::uint32_t seed);

}  // namespace penumbra::differential
