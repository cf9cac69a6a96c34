// The hierarchy by which lights are chosen, see kernels/light/light_tree.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scenes/device/light_bounds.h"

namespace penumbra {

/// Turns below the cut: a trail has a bit for each.
constexpr int kMaxLightTreeDepth = 28;

struct LightTree {
  std::vector<LightNode>
      nodes;  ///< those of the cut first, infinite ones last among them; pairs after their parent
  /// Of each light the number of its node of the cut, times LIGHT_CUT its turns from there on, the first one
  /// lowest; of a light without intensity no way to it.
  std::vector<std::uint32_t> trails;
  int cut = 0;    ///< nodes from which walks begin
  int depth = 0;  ///< turns from there to the lowest leaf
};

/// Over the lights that have an intensity; no node is of both infinite lights and others. Intensities of
/// nodes are those of the bounds times `unit`. Splits by the surface area orientation heuristic (Conty
/// Estevez and Kulla 2018, section 4.4).
LightTree build_light_tree(std::span<const LightBounds> lights, double unit);

}  // namespace penumbra
