// Numbers in JSON.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

namespace penumbra {

/// A number, or null for NaN and infinity, which JSON lacks; null means "unknown".
inline nlohmann::ordered_json json_number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace penumbra
