// Scenes of every format, converted for Mitsuba by `penumbra convert`.
#pragma once

#include <vector>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

std::vector<SceneText> converted_scenes();

}  // namespace penumbra::differential
