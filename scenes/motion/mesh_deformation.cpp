#include "scenes/motion/mesh_deformation.h"

#include <algorithm>

#include "scenes/scene_description.h"
#include "scenes/transform.h"

namespace penumbra {

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
  }
}

void apply_skin(const Skin& skin, std::span<const glm::dmat4> joint_to_world, Mesh& mesh) {
  std::vector<glm::dmat4> moves(joint_to_world.begin(), joint_to_world.end());
  for (std::size_t j = 0; j < moves.size(); ++j) moves[j] = moves[j] * skin.to_joint[j];
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
    if (mesh.normals.empty() || is_singular(move)) continue;
    const glm::dvec3 normal = normal_matrix(move) * glm::dvec3(mesh.normals[i]);
    const double length = glm::length(normal);
    if (length > 0.0) mesh.normals[i] = glm::vec3(normal / length);
  }
}

}  // namespace penumbra
