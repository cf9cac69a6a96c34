// Scenes of every format, which Mitsuba has from `convert`.
#pragma once

#include <vector>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

std::vector<SceneText> converted_scenes();

}  // namespace penumbra::differential
