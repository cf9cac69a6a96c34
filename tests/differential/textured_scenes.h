// Scenes with textures: bitmaps by their edges, filters and transforms, and the texture coordinates of
// shapes.
#pragma once

#include <vector>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

std::vector<SceneText> textured_scenes();

}  // namespace penumbra::differential
