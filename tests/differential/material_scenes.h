// Materials: their sides and lobes, nested ones, normal maps and bump maps.
#pragma once

#include <vector>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

std::vector<SceneText> material_scenes();

}  // namespace penumbra::differential
