#include "scenes/gltf/mesh_pose.h"

#include <fmt/format.h>

#include <cmath>
#include <type_traits>

#include "scenes/transform.h"

namespace penumbra::gltf {
namespace {

/// The transform of each joint, from the mesh's space at binding to world space.
Expected<std::vector<glm::dmat4>> joint_matrices(const Asset& asset, const tinygltf::Skin& skin,
                                                 const std::vector<glm::dmat4>& node_to_world) {
  std::vector<glm::dmat4> result;
  for (const int joint : skin.joints) {
    if (joint < 0 || std::size_t(joint) >= node_to_world.size())
      return fail(fmt::format("a joint is the node {}, which is not there", joint));
    result.push_back(node_to_world[std::size_t(joint)]);
  }
  if (skin.inverseBindMatrices < 0) return result;
  const auto inverse = read_accessor(asset, skin.inverseBindMatrices, 16, 16);
  if (!inverse) return fail(fmt::format("inverseBindMatrices: {}", inverse.error().message));
  if (inverse->count < result.size())
    return fail(fmt::format("inverseBindMatrices: {} for {} joints", inverse->count, result.size()));
  for (std::size_t i = 0; i < result.size(); ++i) {
    glm::dmat4 m;
    for (int k = 0; k < 16; ++k) m[k / 4][k % 4] = inverse->at(i, std::size_t(k));
    result[i] = result[i] * m;
  }
  return result;
}

}  // namespace

Expected<void> morph(const Asset& asset, const tinygltf::Primitive& primitive,
                     std::span<const double> weights, Mesh& mesh) {
  for (std::size_t t = 0; t < primitive.targets.size() && t < weights.size(); ++t) {
    const double weight = weights[t];
    if (weight == 0.0 || !std::isfinite(weight)) continue;
    const auto add = [&](const char* name, auto& to) -> Expected<void> {
      const auto found = primitive.targets[t].find(name);
      if (found == primitive.targets[t].end() || to.empty()) return {};
      const auto change = read_accessor(asset, found->second, 3, 3);
      if (!change) return fail(fmt::format("morph target {}: {}: {}", t, name, change.error().message));
      if (change->count != to.size())
        return fail(fmt::format("morph target {}: {} of {} vertices, where there are {}", t, name,
                                change->count, to.size()));
      for (std::size_t i = 0; i < to.size(); ++i)
        to[i] += std::decay_t<decltype(to[i])>(
            weight * glm::dvec3(change->at(i, 0), change->at(i, 1), change->at(i, 2)));
      return {};
    };
    if (const auto done = add("POSITION", mesh.positions); !done) return done;
    if (const auto done = add("NORMAL", mesh.normals); !done) return done;
  }
  return {};
}

Expected<void> apply_skin(const Asset& asset, const PrimitiveAttributes& attributes, int skin,
                          const std::vector<glm::dmat4>& node_to_world, Mesh& mesh) {
  if (skin < 0 || std::size_t(skin) >= asset.model.skins.size())
    return fail(fmt::format("there is no skin {}", skin));
  const auto joints = joint_matrices(asset, asset.model.skins[std::size_t(skin)], node_to_world);
  if (!joints) return fail(fmt::format("skin {}: {}", skin, joints.error().message));
  const std::size_t count = mesh.positions.size();
  std::vector<glm::dmat4> moves(count, glm::dmat4(0.0));
  std::vector<double> sums(count, 0.0);
  // Each set has four joints per vertex.
  for (int set = 0;; ++set) {
    const std::string name = fmt::format("JOINTS_{}", set), weight_name = fmt::format("WEIGHTS_{}", set);
    const auto indices = attributes.read(name, 4, 4), weights = attributes.read(weight_name, 4, 4);
    if (!indices) return std::unexpected(indices.error());
    if (!weights) return std::unexpected(weights.error());
    if (!*indices && !*weights) break;
    if (!*indices || !*weights) return fail(fmt::format("of {} and {} only one is there", name, weight_name));
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t c = 0; c < 4; ++c) {
        const double weight = (*weights)->at(i, c), joint = (*indices)->at(i, c);
        if (weight == 0.0) continue;
        if (!(joint >= 0 && joint < double(joints->size())))
          return fail(fmt::format("{}: a joint {}, where the skin has {}", name, joint, joints->size()));
        moves[i] += weight * (*joints)[std::size_t(joint)];
        sums[i] += weight;
      }
  }
  for (std::size_t i = 0; i < count; ++i) {
    // Vertices without a joint stay in the space of the first one.
    const glm::dmat4 move = sums[i] > 0.0     ? moves[i] / sums[i]
                            : joints->empty() ? glm::dmat4(1.0)
                                              : joints->front();
    mesh.positions[i] = transform_point(move, mesh.positions[i]);
    if (!mesh.normals.empty() && !is_singular(move)) {
      const glm::dvec3 normal = normal_matrix(move) * glm::dvec3(mesh.normals[i]);
      const double length = glm::length(normal);
      if (length > 0.0) mesh.normals[i] = glm::vec3(normal / length);
    }
  }
  return {};
}

}  // namespace penumbra::gltf
