// Values that change over time, given by keys.
#pragma once

#include <cstddef>
#include <glm/ext/quaternion_double.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace penumbra {

enum class Interpolation { kLinear, kStep, kCubicSpline };

/// A value over time. Before its first key it is that of the first key, after the last that of the last.
template <typename Value>
struct KeyedValue {
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<double> times;  ///< of the keys, in seconds: finite, strictly ascending, at least one
  std::vector<Value> values;  ///< one per key
  /// Derivatives before and after each key, per second; empty unless the interpolation is kCubicSpline.
  std::vector<Value> in_tangents{}, out_tangents{};

  /// Whether the value changes. Keys with equal values and without tangents do not change it.
  [[nodiscard]] bool varies() const;
  /// A value that does not change.
  static KeyedValue constant(Value value) { return {Interpolation::kLinear, {0.0}, {std::move(value)}}; }
};

/// Morph weights: as many numbers for each key.
using Weights = std::vector<double>;

/// The value at a time. kLinear: linear, rotations by spherical linear interpolation along the shorter arc.
/// kCubicSpline: Hermite's polynomial with the tangents of the keys (glTF 2.0, appendix C). Rotations are
/// unit quaternions.
double value_at(const KeyedValue<double>& keys, double time);
glm::dvec3 value_at(const KeyedValue<glm::dvec3>& keys, double time);
glm::dmat3 value_at(const KeyedValue<glm::dmat3>& keys, double time);
glm::dquat value_at(const KeyedValue<glm::dquat>& keys, double time);
Weights value_at(const KeyedValue<Weights>& keys, double time);

}  // namespace penumbra
