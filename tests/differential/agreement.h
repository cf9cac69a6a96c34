// Whether Penumbra and Mitsuba 3 render the same image of a scene, up to noise.
#pragma once

#include <span>
#include <vector>

#include "tests/differential/mitsuba_process.h"
#include "tests/differential/scene_text.h"

namespace penumbra::differential {

/// Renders all scenes by both and adds a failure for each that differs. `all` scenes are compared by all
/// calls together, at a significance of 1 % for all of them. `report`: it says what was found, and keeps the
/// files, of scenes that agree too.
void expect_agreement(MitsubaProcess& mitsuba, std::span<const SceneText> scenes, std::size_t all,
                      bool report);

}  // namespace penumbra::differential
