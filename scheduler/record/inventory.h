// Formats the cost of a scene and of the features left out, for `penumbra info` and statistics.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scenes/device/scene_inventory.h"

namespace penumbra {

/// Only numbers: bytes and seconds, each also for a scene with every feature. Unknown values are null.
nlohmann::ordered_json inventory_json(const SceneInventory& inventory);

/// Two columns: the scene as it is, and with every feature.
std::string inventory_text(const SceneInventory& inventory);

}  // namespace penumbra
