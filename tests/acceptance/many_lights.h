// Scenes with several lights whose power says little about their contributions.
#pragma once

#include <string>
#include <vector>

#include "scenes/scene_description.h"

namespace penumbra {

struct ManyLights {
  std::string name;
  SceneDescription scene;
};

/// 48 x 32 pixels each, path tracing of up to 4 edges: many small emitters and spots, lights in rooms that do
/// not see each other, skies beside lights, indoors and out.
std::vector<ManyLights> many_lights();

}  // namespace penumbra
