// What a scene costs and what was left out, for `penumbra info --json`, statistics and for people.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scenes/device/scene_inventory.h"

namespace penumbra {

/// Numbers only: bytes and seconds, each with what it would be with everything; null for what is not known.
nlohmann::ordered_json inventory_json(const SceneInventory& inventory);

/// Two columns: as it is, and with everything.
std::string inventory_text(const SceneInventory& inventory);

}  // namespace penumbra
