// Meshes whose vertices move: morph targets, then a skin.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "scenes/motion/keyed_value.h"

namespace penumbra {

struct Mesh;

struct MorphTarget {
  std::vector<glm::dvec3> positions;   ///< change of each position for a weight of 1; empty: none
  std::vector<glm::dvec3> normals;     ///< likewise of each normal
  std::vector<glm::dvec3> tangents{};  ///< likewise of the tangents at each vertex
};

/// Joints with their weights for each vertex.
struct Skin {
  struct Influence {
    std::uint32_t joint = 0;  ///< index into `joints`
    double weight = 0.0;      ///< the sum for a vertex may be any; the weights are divided by it
  };
  std::vector<int> joints;            ///< nodes, see SceneMotion
  std::vector<glm::dmat4> to_joint;   ///< from the mesh's space to that of each joint, when bound
  std::vector<std::uint32_t> first;   ///< one more than vertices: where the influences of each begin
  std::vector<Influence> influences;  ///< a vertex without any moves with the first joint
};

struct MeshDeformation {
  std::vector<MorphTarget> targets = {};
  KeyedValue<Weights> weights = {};  ///< of the targets; unless there are targets, without keys
  Skin skin = {};                    ///< without joints: none

  [[nodiscard]] bool has_skin() const { return !skin.joints.empty(); }
};

/// Takes the first of these meshes, at rest, evenly from each to the next. They have equally many vertices,
/// and all have normals or none has. `times`: of each, in seconds, finite and ascending.
MeshDeformation deformation_between(std::span<const Mesh> meshes, std::span<const double> times);

/// The mesh at rest becomes that of a time. `nodes`: of SceneMotion, to the world, at that time.
void deform(const MeshDeformation& deformation, double time, std::span<const glm::dmat4> nodes, Mesh& mesh);

/// Adds the targets times their weights. Missing weights are 0.
void morph(std::span<const MorphTarget> targets, const Weights& weights, Mesh& mesh);

/// Moves each vertex by the weighted mean of its joints' transforms (linear blend skinning), with its
/// tangents, and its normal by that transform's inverse transpose. `joint_to_world`: of each joint, applied
/// after Skin::to_joint.
void apply_skin(const Skin& skin, std::span<const glm::dmat4> joint_to_world, Mesh& mesh);

}  // namespace penumbra
