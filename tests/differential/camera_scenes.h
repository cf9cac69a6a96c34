// A scene of things at many depths, through every camera that Mitsuba 3 has.
#pragma once

#include <vector>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

std::vector<SceneText> camera_scenes();

}  // namespace penumbra::differential
