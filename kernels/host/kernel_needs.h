// The features, families and kinds that kernels are compiled for.
#pragma once

#include <cstdint>

#include "kernels/scene_types.h"

namespace penumbra {

constexpr std::uint64_t kEveryFamily = EVERY_FAMILY;

/// Bit masks.
struct KernelNeeds {
  std::uint64_t features = FEATURE_ALL;             ///< FEATURE_*
  std::uint64_t families = kEveryFamily;            ///< 1 << FAMILY_*
  std::uint32_t light_kinds = ALL_LIGHT_KINDS;      ///< 1 << LIGHT_*
  std::uint32_t texture_kinds = ALL_TEXTURE_KINDS;  ///< 1 << TEXTURE_*
};

/// Exactly what the scene needs.
inline KernelNeeds needs_of(const SceneHeader& h) {
  return {h.features, h.families, h.light_kinds, h.texture_kinds};
}

/// Everything that a scene with the same intersector could need. The BVH is included only if the scene has
/// one.
inline KernelNeeds every_need(const SceneHeader& h) {
  if (h.intersector == INTERSECTOR_EMBREE) return {};
  return {.features = (FEATURE_ALL ^ FEATURE_BVH) | (h.features & FEATURE_BVH)};
}

}  // namespace penumbra
