// Hand-made scenes, one for each bug that was found and each feature that no random scene has.
#pragma once

#include <vector>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

std::vector<SceneText> named_scenes();

}  // namespace penumbra::differential
