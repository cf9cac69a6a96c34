// What values the parameters of plugins take, beside those of settings (setting_values.h): each says in words
// what is right. Textures may stand for colours and numbers of these kinds.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
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

/// A colour whose channels are refractive indices, or absorption: of a spectrum, what it looks like under
/// D65, without a limit.
struct IndexColour {
  [[nodiscard]] bool contains(float value) const { return value >= 0.0f && value <= kMostIndex; }
  [[nodiscard]] std::string values() const;
  static constexpr float kMostIndex = 1e4f;
};

/// The same of a medium: a volume may stand for it. Beyond 1 it is a coefficient in 1 / scene unit.
struct VolumeColour : ColourWithin {};

/// A number with low < value <= high, or low <= value <= high.
struct NumberWithin {
  LowEnd end = LowEnd::kClosed;
  float low = 0.0f, high = 1.0f;
  [[nodiscard]] bool contains(float value) const {
    return (end == LowEnd::kOpen ? value > low : value >= low) && value <= high;
  }
  [[nodiscard]] std::string values() const;
};

/// A point of the scene, a file's name, a transform; what is read is what is given.
struct AnyPoint {
  [[nodiscard]] static std::string values() { return "point"; }
};
struct FileName {
  [[nodiscard]] static std::string values() { return "name of a file"; }
};
/// A number in double precision, which its plugin checks.
struct AnyNumber {
  const char* words;
  [[nodiscard]] std::string values() const { return words; }
};
struct AnyText {
  const char* words;
  [[nodiscard]] std::string values() const { return words; }
};
struct AnyTransform {
  [[nodiscard]] static std::string values() { return "transform"; }
};

constexpr float kAnyNumber = std::numeric_limits<float>::max();

/// Defaults, for people.
std::string print_default(const TexturedColour& colour);
std::string print_default(const TexturedNumber& number);
std::string print_default(const glm::vec3& colour);
std::string print_default(const glm::dvec3& point);
std::string print_default(const glm::dmat4& transform);
std::string print_default(const std::string& text);
std::string print_default(float number);
std::string print_default(double number);
std::string print_default(bool value);

/// Whether a texture may stand for it.
template <typename T>
constexpr bool kMayBeTexture = std::is_same_v<T, TexturedColour> || std::is_same_v<T, TexturedNumber>;

/// What is wrong with a plugin as a whole once its parameters are read, or worth a warning.
struct Finding {
  std::string parameter;  ///< where; empty: the plugin
  std::string message;
  bool is_warning = false;
};
using Findings = std::vector<Finding>;

}  // namespace penumbra
