#include "scenes/gltf/node_transforms.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <utility>

#include "scenes/gltf/accessor.h"
#include "scenes/transform.h"

namespace penumbra::gltf {
namespace {

constexpr double kRounding = 1e-6;  ///< of matrices that were multiplied in single precision

/// Reads a node's transform. Returns what is wrong with its numbers, or null.
const char* read_local(const tinygltf::Node& node, glm::dmat4& result) {
  const auto sized = [](const std::vector<double>& numbers, std::size_t size) {
    return numbers.empty() || numbers.size() == size;
  };
  if (!sized(node.matrix, 16) || !sized(node.translation, 3) || !sized(node.scale, 3) ||
      !sized(node.rotation, 4))
    return "a matrix has 16 numbers, a translation and a scale 3, a rotation 4";
  if (node.matrix.empty()) {
    const auto& q = node.rotation;
    result = transform_of_parts(vector_or(node.translation, 0.0),
                                q.empty() ? glm::dvec4(0, 0, 0, 1) : glm::dvec4(q[0], q[1], q[2], q[3]),
                                vector_or(node.scale, 1.0));
    return nullptr;
  }
  for (int i = 0; i < 16; ++i) result[i / 4][i % 4] = node.matrix[std::size_t(i)];
  for (int i = 0; i < 4; ++i) {
    if (std::abs(result[i].w - (i == 3 ? 1.0 : 0.0)) > kRounding)
      return "the last row of its matrix must be 0 0 0 1";
    result[i].w = i == 3 ? 1.0 : 0.0;
  }
  return nullptr;
}

}  // namespace

glm::dvec3 vector_or(const std::vector<double>& numbers, double fallback) {
  return numbers.size() < 3 ? glm::dvec3(fallback) : glm::dvec3(numbers[0], numbers[1], numbers[2]);
}

glm::dmat4 transform_of_parts(const glm::dvec3& offset, const glm::dvec4& rotation, const glm::dvec3& scale) {
  glm::dquat q(rotation.w, rotation.x, rotation.y, rotation.z);
  const double length = glm::length(q);
  q = length > 0.0 && std::isfinite(length) ? q / length : glm::dquat(1.0, 0.0, 0.0, 0.0);
  return translation(offset) * glm::mat4_cast(q) * scaling(scale);
}

std::vector<int> root_nodes(const Asset& asset, ReaderReport& report) {
  const tinygltf::Model& model = asset.model;
  if (!model.scenes.empty()) {
    const int index = std::max(model.defaultScene, 0);
    if (std::size_t(index) >= model.scenes.size()) {
      report.error(asset.place({"scene"}), fmt::format("there is no scene {}", index));
      return {};
    }
    if (model.scenes.size() > 1)
      report.warn(asset.place({"scenes"}),
                  fmt::format("of {} scenes number {} is shown", model.scenes.size(), index));
    return model.scenes[std::size_t(index)].nodes;
  }
  std::vector<bool> is_child(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes)
    for (const int child : node.children)
      if (child >= 0 && std::size_t(child) < is_child.size()) is_child[std::size_t(child)] = true;
  std::vector<int> result;
  for (std::size_t i = 0; i < is_child.size(); ++i)
    if (!is_child[i]) result.push_back(int(i));
  return result;
}

bool keeps_areas(const glm::dmat4& transform) {
  const glm::dmat3 m(transform);
  const auto area = [&](int i, int j) {
    const double sides = glm::length(m[i]) * glm::length(m[j]);
    return sides > 0.0 && glm::length(glm::cross(m[i], m[j])) > 1e-6 * sides;
  };
  return area(0, 1) || area(1, 2) || area(2, 0);
}

std::optional<glm::dmat4> local_transform(const Asset& asset, std::size_t node, ReaderReport& report) {
  glm::dmat4 result(1.0);
  if (const char* problem = read_local(asset.model.nodes[node], result)) {
    report.error(asset.place({"nodes", node}), fmt::format("node {}: {}", node, problem));
    return std::nullopt;
  }
  return result;
}

std::optional<glm::dmat4> local_transform(const tinygltf::Node& node) {
  glm::dmat4 result(1.0);
  return read_local(node, result) == nullptr ? std::optional(result) : std::nullopt;
}

std::vector<int> node_parents(const Asset& asset) {
  const auto& nodes = asset.model.nodes;
  std::vector<int> parent(nodes.size(), -1);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (const int child : nodes[i].children)
      if (child >= 0 && std::size_t(child) < nodes.size()) parent[std::size_t(child)] = int(i);
  // The walk from which each node was reached first. A parent of the same walk closes a cycle.
  std::vector<std::size_t> walk(nodes.size(), nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (auto at = i; walk[at] == nodes.size();) {
      walk[at] = i;
      if (parent[at] >= 0 && walk[std::size_t(parent[at])] == i) parent[at] = -1;
      if (parent[at] >= 0) at = std::size_t(parent[at]);
    }
  return parent;
}

std::vector<glm::dmat4> world_transforms(const Asset& asset) {
  const auto& nodes = asset.model.nodes;
  const std::vector<int> parent = node_parents(asset);
  std::vector<glm::dmat4> world(nodes.size(), glm::dmat4(1.0));
  std::vector<bool> done(nodes.size(), false);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    // Follow the parents up to a node that is done, then go back.
    std::vector<std::size_t> chain;
    for (int at = int(i); at >= 0 && !done[std::size_t(at)]; at = parent[std::size_t(at)])
      chain.push_back(std::size_t(at));
    for (auto at = chain.rbegin(); at != chain.rend(); ++at) {
      const glm::dmat4 local = local_transform(nodes[*at]).value_or(glm::dmat4(1.0));
      world[*at] = parent[*at] >= 0 ? world[std::size_t(parent[*at])] * local : local;
      done[*at] = true;
    }
  }
  return world;
}

Expected<std::optional<std::vector<glm::dmat4>>> node_instances(const Asset& asset,
                                                                const tinygltf::Node& node) {
  using Result = std::optional<std::vector<glm::dmat4>>;
  const auto extension = node.extensions.find("EXT_mesh_gpu_instancing");
  if (extension == node.extensions.end() || !extension->second.IsObject() ||
      !extension->second.Has("attributes"))
    return Result();
  const tinygltf::Value& attributes = extension->second.Get("attributes");
  std::optional<std::size_t> count;
  const auto read = [&](const char* name, std::size_t components) -> Expected<std::optional<AccessorValues>> {
    if (!attributes.IsObject() || !attributes.Has(name) || !attributes.Get(name).IsInt())
      return std::optional<AccessorValues>();
    auto values = read_accessor(asset, attributes.Get(name).GetNumberAsInt(), components, components);
    if (!values) return fail(fmt::format("EXT_mesh_gpu_instancing: {}: {}", name, values.error().message));
    if (count.value_or(values->count) != values->count)
      return fail(fmt::format("EXT_mesh_gpu_instancing: {} of {} instances, where there are {}", name,
                              values->count, *count));
    count = values->count;
    return std::optional(std::move(*values));
  };
  const auto offsets = read("TRANSLATION", 3), rotations = read("ROTATION", 4), scales = read("SCALE", 3);
  for (const auto* part : {&offsets, &rotations, &scales})
    if (!*part) return std::unexpected(part->error());
  std::vector<glm::dmat4> instances;
  for (std::size_t i = 0; i < count.value_or(0); ++i) {
    const auto at = [&](const std::optional<AccessorValues>& values, std::size_t c, double fallback) {
      return values ? values->at(i, c) : fallback;
    };
    instances.push_back(transform_of_parts(
        {at(*offsets, 0, 0), at(*offsets, 1, 0), at(*offsets, 2, 0)},
        {at(*rotations, 0, 0), at(*rotations, 1, 0), at(*rotations, 2, 0), at(*rotations, 3, 1)},
        {at(*scales, 0, 1), at(*scales, 1, 1), at(*scales, 2, 1)}));
  }
  return Result(std::move(instances));
}

}  // namespace penumbra::gltf
