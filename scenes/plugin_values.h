// What values the parameters of plugins take, beside those of settings (setting_values.h): each says in words
// what is right. Textures may stand for colours and numbers of these kinds.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/setting_values.h"
#include "scenes/textured.h"

namespace penumbra {

/// A colour whose channels are in [low, high].
struct ColourWithin {
  float low = 0.0f, high = 1.0f;
  [[nodiscard]] bool contains(float value) const { return value >= low && value <= high; }
  [[nodiscard]] std::string values() const;
};

/// A number with low < value <= high, or low <= value <= high.
struct NumberWithin {
  LowEnd end = LowEnd::kClosed;
  float low = 0.0f, high = 1.0f;
  [[nodiscard]] bool contains(float value) const {
    return (end == LowEnd::kOpen ? value > low : value >= low) && value <= high;
  }
  [[nodiscard]] std::string values() const;
};

constexpr float kAnyNumber = std::numeric_limits<float>::max();

/// What is wrong with a plugin as a whole once its parameters are read, or worth a warning.
struct Finding {
  std::string parameter;  ///< where; empty: the plugin
  std::string message;
  bool is_warning = false;
};
using Findings = std::vector<Finding>;

}  // namespace penumbra
