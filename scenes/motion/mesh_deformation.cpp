#include "scenes/motion/mesh_deformation.h"

#include <algorithm>

#include "scenes/scene_description.h"
#include "scenes/transform.h"

namespace penumbra {

MeshDeformation deformation_between(std::span<const Mesh> meshes, std::span<const double> times) {
  const Mesh& rest = meshes.front();
  // Empty if nothing changes.
  const auto changes = [](const auto& from, const auto& to) {
    std::vector<glm::dvec3> all;
    if (from == to) return all;
    for (std::size_t i = 0; i < from.size(); ++i) all.push_back(glm::dvec3(to[i]) - glm::dvec3(from[i]));
    return all;
  };
  MeshDeformation made;
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    made.weights.times.push_back(times[k]);
    Weights& weights = made.weights.values.emplace_back(meshes.size() - 1, 0.0);
    if (k == 0) continue;
    weights[k - 1] = 1.0;
    made.targets.push_back(
        {changes(rest.positions, meshes[k].positions), changes(rest.normals, meshes[k].normals)});
  }
  return made;
}

void deform(const MeshDeformation& deformation, double time, std::span<const glm::dmat4> nodes, Mesh& mesh) {
  if (!deformation.targets.empty()) morph(deformation.targets, value_at(deformation.weights, time), mesh);
  if (!deformation.has_skin()) return;
  std::vector<glm::dmat4> joints;
  for (const int joint : deformation.skin.joints) joints.push_back(nodes[std::size_t(joint)]);
  apply_skin(deformation.skin, joints, mesh);
}

void morph(std::span<const MorphTarget> targets, const Weights& weights, Mesh& mesh) {
  const auto add = [](const std::vector<glm::dvec3>& changes, double weight, auto& to) {
    using Vector = std::decay_t<decltype(to[0])>;
    for (std::size_t i = 0; i < std::min(changes.size(), to.size()); ++i)
      to[i] += Vector(weight * changes[i]);
  };
  for (std::size_t t = 0; t < std::min(targets.size(), weights.size()); ++t) {
    if (weights[t] == 0.0) continue;
    add(targets[t].positions, weights[t], mesh.positions);
    add(targets[t].normals, weights[t], mesh.normals);
    if (targets[t].tangents.empty()) continue;
    for (std::size_t i = 0; i < mesh.tangents.size(); ++i)
      for (int c = 0; c < 3; ++c)
        mesh.tangents[i][std::size_t(c)] +=
            glm::vec4(weights[t] * targets[t].tangents[mesh.triangles[i][c]], 0.0);
  }
}

void apply_skin(const Skin& skin, std::span<const glm::dmat4> joint_to_world, Mesh& mesh) {
  std::vector<glm::dmat4> moves(joint_to_world.begin(), joint_to_world.end());
  for (std::size_t j = 0; j < moves.size(); ++j) moves[j] = moves[j] * skin.to_joint[j];
  std::vector<glm::dmat3> of_vertices;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    glm::dmat4 move(0.0);
    double sum = 0.0;
    for (std::uint32_t k = skin.first[i]; k < skin.first[i + 1]; ++k) {
      const auto& [joint, weight] = skin.influences[k];
      move += weight * moves[joint];
      sum += weight;
    }
    move = sum > 0.0 ? move / sum : moves.front();
    mesh.positions[i] = transform_point(move, mesh.positions[i]);
    if (!mesh.tangents.empty()) of_vertices.emplace_back(move);
    if (mesh.normals.empty() || is_singular(move)) continue;
    const glm::dvec3 normal = normal_matrix(move) * glm::dvec3(mesh.normals[i]);
    const double length = glm::length(normal);
    if (length > 0.0) mesh.normals[i] = glm::vec3(normal / length);
  }
  for (std::size_t i = 0; i < mesh.tangents.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      glm::vec4& t = mesh.tangents[i][std::size_t(c)];
      t = glm::vec4(of_vertices[mesh.triangles[i][c]] * glm::dvec3(t), t.w);
    }
}

}  // namespace penumbra
