// A scene of objects at many depths, seen by every camera of Mitsuba 3.
#pragma once

#include <vector>

#include "tests/differential/scene_text.h"

namespace penumbra::differential {

std::vector<SceneText> camera_scenes();

}  // namespace penumbra::differential
