// Scenes by seed: a floor, some shapes, some lights, and settings. What would make two right renderers differ
// is not in them; random_scene.cpp says where and why.
#pragma once

#include <cstdint>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

SceneText random_scene(std::uint32_t seed);

}  // namespace penumbra::differential
