// Scenes with textures: edges, filters and transforms of bitmaps, and texture coordinates of shapes.
#pragma once

#include <vector>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

std::vector<SceneText> textured_scenes();

}  // namespace penumbra::differential
