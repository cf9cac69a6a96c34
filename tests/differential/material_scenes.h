// Materials: their sides and lobes, those that hold others, and maps that bend normals.
#pragma once

#include <vector>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

std::vector<SceneText> material_scenes();

}  // namespace penumbra::differential
