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
  /// Of leaves of several lights those, one leaf after the other, and of each light how many of the
  /// LIGHT_NUMBERS take it there; empty if there is no such leaf.
  std::vector<LightMember> members;
  std::vector<int> numbers;
  int cut = 0;         ///< nodes from which walks begin
  int depth = 0;       ///< turns from there to the lowest leaf
  int leaf_turns = 0;  ///< such that 2^leaf_turns lights are as many as a leaf has, or more
};

/// Lights of one leaf, which are taken there in proportion to their intensities.
using LightGroup = std::vector<int>;
constexpr std::size_t kMostOfLeaf = std::size_t{1} << 20;

/// Over the lights that have an intensity; no node is of both infinite lights and others. Intensities of
/// nodes are those of the bounds times `unit`. Splits by the surface area orientation heuristic (Conty
/// Estevez and Kulla 2018, section 4.4).
///
/// `groups`: of lights that have an intensity, are not infinite and in no other group; the others are by
/// themselves. `most_of_cut`: up to LIGHT_CUT; lights of both kinds take 2 in any case.
LightTree build_light_tree(std::span<const LightBounds> lights, double unit,
                           std::span<const LightGroup> groups = {}, int most_of_cut = LIGHT_CUT);

}  // namespace penumbra
