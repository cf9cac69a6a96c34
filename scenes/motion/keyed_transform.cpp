#include "scenes/motion/keyed_transform.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <utility>

#include "scenes/transform.h"

namespace penumbra {
namespace {

struct PolarParts {
  glm::dquat rotation;  ///< does not mirror
  glm::dmat3 stretch;   ///< M = rotation * stretch
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

bool is_finite(const glm::dmat4& m) {
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      if (!std::isfinite(m[i][j])) return false;
  return true;
}

}  // namespace

glm::dmat4 transform_at(const KeyedTransform& keys, double time) {
  glm::dmat4 result(glm::mat3_cast(value_at(keys.rotation, time)) * value_at(keys.stretch, time));
  result[3] = glm::dvec4(value_at(keys.translation, time), 1.0);
  return result;
}

Expected<KeyedTransform> keyed_transform(std::span<const TransformKey> keys) {
  if (keys.empty()) return fail("an animation needs at least one key");
  KeyedTransform result{{}, {}, {}};
  std::vector<double> times;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto& [time, transform] = keys[i];
    if (!std::isfinite(time)) return fail(fmt::format("key {}: its time must be finite", i + 1));
    if (i > 0 && !(time > times.back()))
      return fail(fmt::format("key {}: times must ascend: {} comes after {}", i + 1, time, times.back()));
    if (!is_finite(transform)) return fail(fmt::format("key {}: its transform must be finite", i + 1));
    if (is_singular(transform)) return fail(fmt::format("key {}: its transform is singular", i + 1));
    if (i > 0 && is_mirror(transform) != is_mirror(keys[i - 1].transform))
      return fail(
          fmt::format("keys {} and {}: one mirrors and the other does not, so that between them there "
                      "is a time without any size",
                      i, i + 1));
    times.push_back(time);
    const PolarParts parts = polar_parts(glm::dmat3(transform));
    result.translation.values.emplace_back(transform[3]);
    result.rotation.values.push_back(parts.rotation);
    result.stretch.values.push_back(parts.stretch);
  }
  result.translation.times = result.rotation.times = result.stretch.times = times;
  return result;
}

}  // namespace penumbra
