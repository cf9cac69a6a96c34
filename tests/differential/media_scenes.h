// Participating media: inside and around objects, with all phase functions, on grids.
#pragma once

#include <vector>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

std::vector<SceneText> media_scenes();

}  // namespace penumbra::differential
