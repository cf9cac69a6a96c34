// The types of plugin parameters, beside those of settings (setting_values.h). Each describes its accepted
// values in words. Colours and numbers of these types may be textures.
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

/// A colour whose channels are refractive indices or absorption coefficients. A spectrum is converted as a
/// reflectance under D65, but without an upper limit.
struct IndexColour {
  [[nodiscard]] bool contains(float value) const { return value >= 0.0f && value <= kMostIndex; }
  [[nodiscard]] std::string values() const;
  static constexpr float kMostIndex = 1e4f;
};

/// A colour of a medium, which may be a volume. With an upper limit above 1 it is a coefficient in 1 / scene
/// unit.
struct VolumeColour : ColourWithin {
  bool is_emission = false;  ///< spectra are converted as those of lights
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

/// A point in the scene, a file name or a transform. The value is taken as it is.
struct AnyPoint {
  [[nodiscard]] static std::string values() { return "point"; }
};
struct FileName {
  [[nodiscard]] static std::string values() { return "name of a file"; }
};
/// A number in double precision. The plugin itself checks its range.
struct AnyNumber {
  const char* words;
  [[nodiscard]] std::string values() const { return words; }
};
struct AnyText {
  constexpr explicit AnyText(const char* what) : words(what) {}
  const char* words;
  [[nodiscard]] std::string values() const { return words; }
};
struct AnyTransform {
  [[nodiscard]] static std::string values() { return "transform"; }
};

constexpr float kAnyNumber = std::numeric_limits<float>::max();

/// Default values as text, for the reference.
std::string print_default(const TexturedColour& colour);
std::string print_default(const TexturedNumber& number);
std::string print_default(const glm::vec3& colour);
std::string print_default(const glm::dvec3& point);
std::string print_default(const glm::dmat4& transform);
std::string print_default(const std::string& text);
std::string print_default(float number);
std::string print_default(double number);
std::string print_default(bool value);

/// Whether a parameter of type T may be a texture.
template <typename T>
constexpr bool kMayBeTexture = std::is_same_v<T, TexturedColour> || std::is_same_v<T, TexturedNumber>;

/// An error or warning about a plugin, found after all its parameters were read.
struct Finding {
  std::string parameter;  ///< the parameter concerned; empty: the plugin as a whole
  std::string message;
  bool is_warning = false;
};
using Findings = std::vector<Finding>;

/// Reports a parameter whose value is not in [low, high].
void check_within(Findings& findings, const char* name, double value, double low, double high);

}  // namespace penumbra
