// Hand-made scenes: one for each bug found, and for each feature that random scenes lack.
#pragma once

#include <vector>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

std::vector<SceneText> named_scenes();

}  // namespace penumbra::differential
