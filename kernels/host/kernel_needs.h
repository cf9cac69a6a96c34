// What kernels are compiled with.
#pragma once

#include <cstdint>

#include "kernels/scene_types.h"

namespace penumbra {

constexpr std::uint32_t kEveryFamily = EVERY_FAMILY;

/// Bit masks.
struct KernelNeeds {
  std::uint64_t features = FEATURE_ALL;             ///< FEATURE_*
  std::uint32_t families = kEveryFamily;            ///< 1 << FAMILY_*
  std::uint32_t light_kinds = ALL_LIGHT_KINDS;      ///< 1 << LIGHT_*
  std::uint32_t texture_kinds = ALL_TEXTURE_KINDS;  ///< 1 << TEXTURE_*
};

/// Exactly what the scene needs.
inline KernelNeeds needs_of(const SceneHeader& h) {
  return {h.features, h.families, h.light_kinds, h.texture_kinds};
}

/// Everything that such a scene could need: a hierarchy that it does not have cannot be traced.
inline KernelNeeds every_need(const SceneHeader& h) {
  if (h.intersector == INTERSECTOR_EMBREE) return {};
  return {.features = (FEATURE_ALL ^ FEATURE_BVH) | (h.features & FEATURE_BVH)};
}

}  // namespace penumbra
