#include "scenes/gltf/moving_nodes.h"

#include <utility>

#include "scenes/gltf/node_transforms.h"

namespace penumbra::gltf {
namespace {

bool moves_node(const NodeKeys& keys) {
  return varies(keys.translation) || varies(keys.rotation) || varies(keys.scale);
}

glm::dmat3 stretch_of(const glm::dvec3& scale) {
  return {scale.x, 0.0, 0.0, 0.0, scale.y, 0.0, 0.0, 0.0, scale.z};
}

template <typename To, typename From>
KeyedValue<To> converted(const KeyedValue<From>& keys, const auto& convert) {
  KeyedValue<To> result{keys.interpolation, keys.times, {}};
  for (const From& value : keys.values) result.values.push_back(convert(value));
  for (const From& tangent : keys.in_tangents) result.in_tangents.push_back(convert(tangent));
  for (const From& tangent : keys.out_tangents) result.out_tangents.push_back(convert(tangent));
  return result;
}

}  // namespace

MovingNodes::MovingNodes(const Asset& asset, const Animation& animation,
                         const std::vector<glm::dmat4>& node_to_world)
    : asset_(asset),
      animation_(animation),
      node_to_world_(node_to_world),
      parents_(node_parents(asset)),
      moves_(asset.model.nodes.size(), false) {
  for (const auto& [index, keys] : animation.nodes)
    if (moves_node(keys)) moves_[index] = true;
  // What is below follows.
  std::vector<std::size_t> pending;
  for (std::size_t i = 0; i < moves_.size(); ++i)
    if (moves_[i]) pending.push_back(i);
  while (!pending.empty()) {
    const std::size_t node = pending.back();
    pending.pop_back();
    for (const int child : asset.model.nodes[node].children)
      if (child >= 0 && std::size_t(child) < moves_.size() && parents_[std::size_t(child)] == int(node) &&
          !moves_[std::size_t(child)]) {
        moves_[std::size_t(child)] = true;
        pending.push_back(std::size_t(child));
      }
  }
}

int MovingNodes::index_of(std::size_t node) {
  // Up to a node that is known or does not move, then back.
  std::vector<std::size_t> chain;
  int at = int(node);
  for (; at >= 0 && !known_.contains(std::size_t(at)); at = parents_[std::size_t(at)]) {
    chain.push_back(std::size_t(at));
    if (!moves(std::size_t(at))) break;
  }
  for (; !chain.empty(); chain.pop_back()) {
    const std::size_t each = chain.back();
    const int above = parents_[each];
    const int parent = moves(each) && above >= 0 ? known_.at(std::size_t(above)) : -1;
    known_[each] = int(nodes_.size());
    nodes_.push_back(moves(each) ? moving(each, parent) : MovingNode{-1, node_to_world_[each]});
  }
  return known_.at(node);
}

MovingNode MovingNodes::moving(std::size_t node, int parent) const {
  const tinygltf::Node& from = asset_.model.nodes[node];
  MovingNode result{parent};
  const auto found = animation_.nodes.find(node);
  if (found == animation_.nodes.end() || !moves_node(found->second)) {
    result.to_parent = local_transform(from).value_or(glm::dmat4(1.0));
    return result;
  }
  const NodeKeys& keys = found->second;
  const auto& q = from.rotation;
  using Vectors = KeyedValue<glm::dvec3>;
  result.keys = KeyedTransform{
      keys.translation.value_or(Vectors::constant(vector_or(from.translation, 0.0))),
      keys.rotation.value_or(KeyedValue<glm::dquat>::constant(
          q.size() == 4 ? glm::dquat(q[3], q[0], q[1], q[2]) : glm::dquat(1.0, 0.0, 0.0, 0.0))),
      converted<glm::dmat3>(keys.scale.value_or(Vectors::constant(vector_or(from.scale, 1.0))), stretch_of)};
  return result;
}

NodePlace MovingNodes::shown_with(const KeyedValue<double>& visible, const NodePlace& place) {
  KeyedTransform keys;
  keys.stretch =
      converted<glm::dmat3>(visible, [](double shown) { return glm::dmat3(shown != 0.0 ? 1.0 : 0.0); });
  int node = place.node;
  if (place.to_node != glm::dmat4(1.0)) {
    nodes_.push_back({node, place.to_node});
    node = int(nodes_.size()) - 1;
  }
  nodes_.push_back({node, glm::dmat4(1.0), std::move(keys)});
  return {int(nodes_.size()) - 1};
}

}  // namespace penumbra::gltf
