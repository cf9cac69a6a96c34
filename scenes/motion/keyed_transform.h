// Transforms over time.
#pragma once

#include <glm/mat4x4.hpp>
#include <optional>
#include <span>

#include "kernels/host/error.h"
#include "scenes/motion/keyed_value.h"

namespace penumbra {

/// First stretches, then rotates, then translates. The parts have keys of their own.
struct KeyedTransform {
  KeyedValue<glm::dvec3> translation = KeyedValue<glm::dvec3>::constant(glm::dvec3(0.0));
  KeyedValue<glm::dquat> rotation = KeyedValue<glm::dquat>::constant(glm::dquat(1.0, 0.0, 0.0, 0.0));
  KeyedValue<glm::dmat3> stretch = KeyedValue<glm::dmat3>::constant(glm::dmat3(1.0));

  [[nodiscard]] bool varies() const { return translation.varies() || rotation.varies() || stretch.varies(); }
};

glm::dmat4 transform_at(const KeyedTransform& keys, double time);

struct TransformKey {
  double time = 0.0;  ///< in seconds
  glm::dmat4 transform{1.0};
};

/// Keys that are matrices. Each is decomposed into a rotation and a symmetric stretch (polar decomposition:
/// Shoemake and Duff 1992, "Matrix animation and polar decomposition"), and all parts are interpolated
/// linearly. Errors, which name the key: no keys; times that are not finite or do not ascend; a transform
/// that is singular or has numbers that are not finite; one that mirrors while that before it does not, or
/// the reverse: between them everything would be flattened to nothing.
Expected<KeyedTransform> keyed_transform(std::span<const TransformKey> keys);

/// A transform whose parent may move as well.
struct MovingNode {
  int parent = -1;                          ///< index of a node before this one, or -1: the world
  glm::dmat4 to_parent{1.0};                ///< if there are no keys
  std::optional<KeyedTransform> keys = {};  ///< to the parent
};

}  // namespace penumbra
