// Scenes made by hand, one for each thing that was once wrong, or that no random scene has.
#pragma once

#include <vector>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

std::vector<SceneText> named_scenes();

}  // namespace penumbra::differential
