#include "scenes/gltf/deformation_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "scenes/gltf/primitive.h"
#include "scenes/gltf/tangents.h"
#include "scenes/mikktspace.h"

namespace penumbra::gltf {
namespace {

/// The joints of a skin and their bind transforms, without influences.
Expected<Skin> read_joints(const Asset& asset, const tinygltf::Skin& skin) {
  Skin result;
  for (const int joint : skin.joints)
    if (joint < 0 || std::size_t(joint) >= asset.model.nodes.size())
      return fail(fmt::format("a joint is the node {}, which is not there", joint));
  result.joints = skin.joints;
  result.to_joint.assign(result.joints.size(), glm::dmat4(1.0));
  if (skin.inverseBindMatrices < 0) return result;
  const auto inverse = read_accessor(asset, skin.inverseBindMatrices, 16, 16);
  if (!inverse) return fail(fmt::format("inverseBindMatrices: {}", inverse.error().message));
  if (inverse->count < result.joints.size())
    return fail(fmt::format("inverseBindMatrices: {} for {} joints", inverse->count, result.joints.size()));
  for (std::size_t i = 0; i < result.joints.size(); ++i)
    for (int k = 0; k < 16; ++k) result.to_joint[i][k / 4][k % 4] = inverse->at(i, std::size_t(k));
  return result;
}

/// The morph targets of a primitive. One that is not `wanted`, or beyond these, changes nothing and is not
/// read. Errors: those of read_accessor; targets with another number of vertices.
Expected<std::vector<MorphTarget>> read_targets(const Asset& asset, const tinygltf::Primitive& primitive,
                                                const std::vector<bool>& wanted, const Mesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  std::vector<MorphTarget> targets(std::min(primitive.targets.size(), wanted.size()));
  for (std::size_t t = 0; t < targets.size(); ++t) {
    if (!wanted[t]) continue;
    const auto read = [&](const char* name, auto& changes) -> Expected<void> {
      const auto found = primitive.targets[t].find(name);
      if (found == primitive.targets[t].end()) return {};
      const auto change = read_accessor(asset, found->second, 3, 3);
      if (!change) return fail(fmt::format("morph target {}: {}: {}", t, name, change.error().message));
      if (change->count != vertices)
        return fail(fmt::format("morph target {}: {} of {} vertices, where there are {}", t, name,
                                change->count, vertices));
      for (std::size_t i = 0; i < vertices; ++i)
        changes.emplace_back(change->at(i, 0), change->at(i, 1), change->at(i, 2));
      return {};
    };
    if (const auto done = read("POSITION", targets[t].positions); !done) return std::unexpected(done.error());
    if (mesh.normals.empty()) continue;
    if (const auto done = read("NORMAL", targets[t].normals); !done) return std::unexpected(done.error());
    if (mesh.tangents.empty()) continue;
    if (const auto done = read("TANGENT", targets[t].tangents); !done) return std::unexpected(done.error());
  }
  return targets;
}

/// A skin with the influences of a primitive's vertices. Its joints are nodes of the file, and all are there.
Expected<Skin> read_skin(const Asset& asset, const PrimitiveAttributes& attributes, int skin) {
  if (skin < 0 || std::size_t(skin) >= asset.model.skins.size())
    return fail(fmt::format("there is no skin {}", skin));
  auto result = read_joints(asset, asset.model.skins[std::size_t(skin)]);
  if (!result) return fail(fmt::format("skin {}: {}", skin, result.error().message));
  // Each set has four joints per vertex.
  std::vector<AccessorValues> joints, weights;
  for (std::size_t set = 0;; ++set) {
    const std::string name = fmt::format("JOINTS_{}", set), weight_name = fmt::format("WEIGHTS_{}", set);
    auto indices = attributes.read(name, 4, 4), shares = attributes.read(weight_name, 4, 4);
    if (!indices) return std::unexpected(indices.error());
    if (!shares) return std::unexpected(shares.error());
    if (!*indices && !*shares) break;
    if (!*indices || !*shares) return fail(fmt::format("of {} and {} only one is there", name, weight_name));
    joints.push_back(std::move(**indices));
    weights.push_back(std::move(**shares));
  }
  result->first.push_back(0);
  for (std::size_t i = 0; i < attributes.vertices(); ++i) {
    for (std::size_t set = 0; set < joints.size(); ++set)
      for (std::size_t c = 0; c < 4; ++c) {
        const double weight = weights[set].at(i, c), joint = joints[set].at(i, c);
        if (weight == 0.0) continue;
        if (!(joint >= 0 && joint < double(result->joints.size())))
          return fail(
              fmt::format("JOINTS_{}: a joint {}, where the skin has {}", set, joint, result->joints.size()));
        result->influences.push_back({std::uint32_t(joint), weight});
      }
    result->first.push_back(std::uint32_t(result->influences.size()));
  }
  return result;
}

}  // namespace

Expected<PosedMesh> read_posed(std::size_t index, const tinygltf::Primitive& primitive, int texcoord,
                               bool wants_tangents, const PoseReading& reading) {
  const Asset& asset = reading.asset;
  const tinygltf::Node& node = asset.model.nodes[index];
  const auto attributes = PrimitiveAttributes::open(asset, primitive);
  if (!attributes) return std::unexpected(attributes.error());
  auto mesh = read_primitive(*attributes, primitive.mode, texcoord);
  if (!mesh) return std::unexpected(mesh.error());
  if (wants_tangents && !mesh->normals.empty()) {
    const auto tangents = attributes->read("TANGENT", 4, 4);
    if (!tangents) return std::unexpected(tangents.error());
    if (*tangents) set_tangents(**tangents, *mesh);
  }
  const bool computes_tangents = wants_tangents && mesh->tangents.empty() && !mesh->texcoords.empty();
  PosedMesh posed{std::move(*mesh)};
  Skin skin;
  if (node.skin >= 0) {
    auto found = read_skin(asset, *attributes, node.skin);
    if (!found) return std::unexpected(found.error());
    skin = std::move(*found);
  }
  const auto found = reading.animation.nodes.find(index);
  const KeyedValue<Weights>* keys = found != reading.animation.nodes.end() && varies(found->second.weights)
                                        ? &*found->second.weights
                                        : nullptr;
  Weights weights = node.weights.empty() ? asset.model.meshes[std::size_t(node.mesh)].weights : node.weights;
  std::vector<bool> wanted(keys != nullptr ? primitive.targets.size() : weights.size(), true);
  if (keys == nullptr)
    for (std::size_t t = 0; t < weights.size(); ++t) {
      if (!std::isfinite(weights[t])) weights[t] = 0.0;
      wanted[t] = weights[t] != 0.0;
    }
  auto targets = read_targets(asset, primitive, wanted, posed.mesh);
  if (!targets) return std::unexpected(targets.error());
  const bool morphs = keys != nullptr && !targets->empty();
  if (!morphs) morph(*targets, weights, posed.mesh);
  if (!morphs && std::ranges::none_of(skin.joints,
                                      [&](int joint) { return reading.moving.moves(std::size_t(joint)); })) {
    std::vector<glm::dmat4> joints;
    for (const int joint : skin.joints) joints.push_back(reading.node_to_world[std::size_t(joint)]);
    if (!joints.empty()) apply_skin(skin, joints, posed.mesh);
    if (computes_tangents) posed.mesh.tangents = mikktspace_tangents(posed.mesh);
    return posed;
  }
  posed.mesh.computes_tangents = computes_tangents;
  MeshDeformation deformation;
  if (morphs) {
    deformation.targets = std::move(*targets);
    deformation.weights = *keys;
  }
  for (int& joint : skin.joints) joint = reading.moving.index_of(std::size_t(joint));
  deformation.skin = std::move(skin);
  posed.deformation = std::make_shared<const MeshDeformation>(std::move(deformation));
  return posed;
}

}  // namespace penumbra::gltf
