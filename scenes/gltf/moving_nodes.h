// Which nodes of a glTF file move, and how: its hierarchy as the nodes of a SceneMotion.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "scenes/gltf/animation_reader.h"
#include "scenes/gltf/asset.h"

namespace penumbra::gltf {

class MovingNodes {
 public:
  /// `node_to_world`: see world_transforms. All must outlive this.
  MovingNodes(const Asset& asset, const Animation& animation, const std::vector<glm::dmat4>& node_to_world);

  /// Whether the node's place in the world changes.
  [[nodiscard]] bool moves(std::size_t node) const { return moves_[node]; }

  /// The index into nodes() of a node of the file. It is added with what is above it and moves; what is above
  /// and does not move becomes one transform.
  int index_of(std::size_t node);

  /// A node at `place` that flattens everything while a node of the file is not visible.
  NodePlace shown_with(const KeyedValue<double>& visible, const NodePlace& place);

  [[nodiscard]] const std::vector<MovingNode>& nodes() const { return nodes_; }

 private:
  [[nodiscard]] MovingNode moving(std::size_t node, int parent) const;

  const Asset& asset_;
  const Animation& animation_;
  const std::vector<glm::dmat4>& node_to_world_;
  std::vector<int> parents_;
  std::vector<bool> moves_;
  std::vector<MovingNode> nodes_{};
  std::map<std::size_t, int> known_{};  ///< indices of nodes, by their index in the file
};

}  // namespace penumbra::gltf
