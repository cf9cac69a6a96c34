#include "scenes/mitsuba/animation.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <string_view>

#include "scenes/transform.h"

namespace penumbra::mitsuba {
namespace {

/// M = rotation * stretch; the rotation does not mirror.
struct PolarParts {
  glm::dquat rotation;
  glm::dmat3 stretch;
};

/// The orthogonal matrix nearest to M, found by averaging M and its inverse transpose until it no longer
/// changes (Higham 1986). M must not be singular.
PolarParts polar_parts(const glm::dmat3& m) {
  glm::dmat3 q = m;
  for (int step = 0; step < 100; ++step) {
    const glm::dmat3 next = 0.5 * (q + glm::transpose(glm::inverse(q)));
    double change = 0.0;
    for (int column = 0; column < 3; ++column) change += glm::length(next[column] - q[column]);
    q = next;
    if (change < 1e-15) break;
  }
  if (glm::determinant(q) < 0.0) q = -q;
  return {glm::normalize(glm::quat_cast(q)), glm::transpose(q) * m};
}

double number_of(const Object* sensor, std::string_view name) {
  if (sensor == nullptr) return 0.0;
  for (const Parameter& parameter : sensor->parameters) {
    if (parameter.name != name) continue;
    if (const auto* number = std::get_if<double>(&parameter.value)) return *number;
    if (const auto* whole = std::get_if<std::int64_t>(&parameter.value)) return double(*whole);
  }
  return 0.0;
}

double shutter_opens(const Object* sensor) { return number_of(sensor, "shutter_open"); }

}  // namespace

Shutter shutter_of(const Context& context) {
  for (const Child& child : context.tree.scene.children) {
    const Object* object = child.object;
    if (object == nullptr || object->tag != "sensor") continue;
    const double open = shutter_opens(object);
    return {open, std::max(open, number_of(object, "shutter_close"))};
  }
  return {};
}

glm::dmat4 transform_at(const AnimationValue& animation, double time) {
  const std::vector<AnimationValue::Key>& keys = animation.keys;
  const auto after = std::ranges::find_if(keys, [&](const auto& key) { return key.time > time; });
  if (after == keys.begin()) return keys.front().transform;
  if (after == keys.end()) return keys.back().transform;
  const AnimationValue::Key &from = *(after - 1), &to = *after;
  const double t = (time - from.time) / (to.time - from.time);
  if (t == 0.0) return from.transform;
  const PolarParts a = polar_parts(glm::dmat3(from.transform)), b = polar_parts(glm::dmat3(to.transform));
  const glm::dmat3 stretch = (1.0 - t) * a.stretch + t * b.stretch;
  glm::dmat4 result(glm::mat3_cast(glm::slerp(a.rotation, b.rotation, t)) * stretch);
  result[3] = (1.0 - t) * from.transform[3] + t * to.transform[3];
  return result;
}

void freeze_animations(const Context& context, const Object* sensor) {
  const double time = shutter_opens(sensor);
  std::size_t count = 0;
  SourceLocation first;
  for (Object& object : context.tree.objects) {
    for (Parameter& parameter : object.parameters) {
      const auto* animation = std::get_if<AnimationValue>(&parameter.value);
      if (animation == nullptr) continue;
      if (count++ == 0) first = parameter.location;
      const glm::dmat4 frozen = transform_at(*animation, time);
      if (is_singular(frozen))
        context.diagnostics.error(
            parameter.location, fmt::format("the transform is singular at time {}, between two keys", time));
      parameter.value = frozen;
      if (object.tag == "shape" && parameter.name == "animation") parameter.name = "to_world";
    }
  }
  if (count > 0)
    context.diagnostics.warn(
        first, fmt::format("nothing moves in Penumbra: {} as at time {}, when the shutter opens",
                           count == 1 ? "the animation is" : fmt::format("{} animations are", count), time));
}

}  // namespace penumbra::mitsuba
