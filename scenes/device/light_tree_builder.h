// The hierarchy by which lights are chosen, see kernels/light/light_tree.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scenes/device/light_bounds.h"

namespace penumbra {

/// A trail has a bit for each turn.
constexpr int kMaxLightTreeDepth = 32;

struct LightTree {
  std::vector<LightNode> nodes;       ///< the root first, neighbours after their parent
  std::vector<std::uint32_t> trails;  ///< of each light; of one without intensity no way to it
  int depth = 0;                      ///< turns from the root to the lowest leaf
};

/// Over the lights that have an intensity; infinite ones are a subtree of their own. Intensities of nodes are
/// those of the bounds times `unit`. Splits by the surface area orientation heuristic (Conty Estevez and
/// Kulla 2018, section 4.4).
LightTree build_light_tree(std::span<const LightBounds> lights, double unit);

}  // namespace penumbra
