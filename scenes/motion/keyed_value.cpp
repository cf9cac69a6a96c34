#include "scenes/motion/keyed_value.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>

namespace penumbra {
namespace {

/// The key before a time, and the position between it and the next key, in [0, 1). At and outside the ends
/// the position is 0.
struct Place {
  std::size_t key = 0;
  double t = 0.0;
  double seconds = 0.0;  ///< from this key to the next
};

Place place_of(const std::vector<double>& times, double time) {
  const auto after = std::ranges::upper_bound(times, time);
  if (after == times.begin()) return {};
  const auto key = std::size_t(after - times.begin()) - 1;
  if (after == times.end()) return {key};
  const double seconds = *after - times[key];
  return {key, (time - times[key]) / seconds, seconds};
}

template <typename Value>
Value sum(const Value& a, double s, const Value& b, double t) {
  return a * s + b * t;
}
Weights sum(const Weights& a, double s, const Weights& b, double t) {
  Weights result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] * s + b[i] * t;
  return result;
}

template <typename Value>
Value between(const Value& a, const Value& b, double t) {
  return sum(a, 1.0 - t, b, t);
}
glm::dquat between(const glm::dquat& a, const glm::dquat& b, double t) {
  return glm::slerp(glm::normalize(a), glm::normalize(b), t);
}

template <typename Value>
Value valid(const Value& value) {
  return value;
}
glm::dquat valid(const glm::dquat& value) {
  const double length = glm::length(value);
  return length > 0.0 ? value / length : glm::dquat(1.0, 0.0, 0.0, 0.0);
}

template <typename Value>
Value evaluate(const KeyedValue<Value>& keys, double time) {
  const Place place = place_of(keys.times, time);
  const Value& from = keys.values[place.key];
  if (place.t == 0.0 || keys.interpolation == Interpolation::kStep) return valid(from);
  const Value& to = keys.values[place.key + 1];
  if (keys.interpolation == Interpolation::kLinear) return valid(between(from, to, place.t));
  const double t = place.t, s = 1.0 - t, length = place.seconds;
  return valid(sum(sum(from, (1.0 + 2.0 * t) * s * s, keys.out_tangents[place.key], length * t * s * s), 1.0,
                   sum(to, t * t * (3.0 - 2.0 * t), keys.in_tangents[place.key + 1], -length * t * t * s),
                   1.0));
}

template <typename Value>
bool is_zero(const Value& value) {
  return value == Value(value - value);
}
bool is_zero(const Weights& value) {
  return std::ranges::all_of(value, [](double w) { return w == 0.0; });
}

}  // namespace

template <typename Value>
bool KeyedValue<Value>::varies() const {
  const auto all_zero = [](const std::vector<Value>& tangents) {
    return std::ranges::all_of(tangents, [](const Value& tangent) { return is_zero(tangent); });
  };
  return times.size() > 1 && !(std::ranges::all_of(values, [&](const Value& v) { return v == values[0]; }) &&
                               all_zero(in_tangents) && all_zero(out_tangents));
}

template struct KeyedValue<double>;
template struct KeyedValue<glm::dvec3>;
template struct KeyedValue<glm::dmat3>;
template struct KeyedValue<glm::dquat>;
template struct KeyedValue<Weights>;

double value_at(const KeyedValue<double>& keys, double time) { return evaluate(keys, time); }
glm::dvec3 value_at(const KeyedValue<glm::dvec3>& keys, double time) { return evaluate(keys, time); }
glm::dmat3 value_at(const KeyedValue<glm::dmat3>& keys, double time) { return evaluate(keys, time); }
glm::dquat value_at(const KeyedValue<glm::dquat>& keys, double time) { return evaluate(keys, time); }
Weights value_at(const KeyedValue<Weights>& keys, double time) { return evaluate(keys, time); }

}  // namespace penumbra
