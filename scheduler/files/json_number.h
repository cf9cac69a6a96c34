// Numbers in JSON.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

namespace penumbra {

/// JSON has no NaN or infinity; null stands for "not known".
inline nlohmann::ordered_json json_number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace penumbra
