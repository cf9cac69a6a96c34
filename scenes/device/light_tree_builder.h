// Builds the hierarchy by which lights are chosen; see kernels/light/light_tree.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scenes/device/light_bounds.h"

namespace penumbra {

/// The largest depth below the cut. A trail has one bit per level.
constexpr int kMaxLightTreeDepth = 28;

struct LightTree {
  /// First the nodes of the cut, infinite lights last among them; then pairs of siblings, after their parent.
  std::vector<LightNode> nodes;
  /// The trail to each light: the index of its node of the cut, plus LIGHT_CUT times the bits of the turns
  /// from there on, first turn lowest. A light without intensity has no meaningful trail.
  std::vector<std::uint32_t> trails;
  /// The lights of leaves with several lights, leaf by leaf, and how many of the LIGHT_PROBABILITY_STEPS
  /// random numbers select each of them. Empty if there is no such leaf.
  std::vector<LightMember> members;
  std::vector<int> numbers;
  int cut = 0;         ///< number of nodes at which traversals begin
  int depth = 0;       ///< number of levels from there to the lowest leaf
  int leaf_turns = 0;  ///< 2^leaf_turns is at least the number of lights in any leaf
};

/// A light cluster: the lights of one leaf, which are chosen in proportion to their intensities.
using LightGroup = std::vector<int>;
constexpr std::size_t kMostOfLeaf = std::size_t{1} << 20;

/// Builds the tree over all lights with a positive intensity. No node contains both infinite and finite
/// lights. The intensity of a node is that of the bounds times `unit`. Nodes are split by the surface area
/// orientation heuristic (Conty Estevez and Kulla 2018, section 4.4).
///
/// `groups`: disjoint clusters of finite lights with positive intensities; each remaining light is a leaf of
/// its own. `most_of_cut`: the largest number of nodes in the cut, up to LIGHT_CUT. If there are both finite
/// and infinite lights, it has at least 2.
LightTree build_light_tree(std::span<const LightBounds> lights, double unit,
                           std::span<const LightGroup> groups = {}, int most_of_cut = LIGHT_CUT);

}  // namespace penumbra
