// Materials as readers assemble them: trees of BSDFs, which may share subtrees, one for each side of a
// surface.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "scenes/scene_description.h"

namespace penumbra {

/// A BSDF of one side with its children. A null tree is black.
struct MaterialNode;
using MaterialTree = std::shared_ptr<const MaterialNode>;
struct MaterialNode {
  Bsdf bsdf;
  MaterialTree first, second;  ///< a blend has both children; a mask only `second`
};

/// The BSDF trees of the two sides of a surface.
struct SurfaceMaterial {
  MaterialTree front, back;
};

/// A tree of one BSDF without children.
MaterialTree leaf(std::string name, BsdfModel model);

/// A blend of two trees, or a mask of the second.
MaterialTree branch(std::string name, BsdfModel model, MaterialTree first, MaterialTree second);

/// The material of a single BSDF; its back side is the BSDF's other_side(), if it has one.
SurfaceMaterial surface_of(const std::string& name, const BsdfModel& model);

/// The mask of both sides of a material, and the blend of two materials. Sides that were the same remain the
/// same.
SurfaceMaterial masked(const std::string& name, const MaskBsdf& mask, const SurfaceMaterial& inside);
SurfaceMaterial blended(const std::string& name, const BlendBsdf& blend, const SurfaceMaterial& first,
                        const SurfaceMaterial& second);

/// The material with a medium behind its front, which is a single BSDF.
SurfaceMaterial filled(const SurfaceMaterial& material, const InnerMedium& inside);

/// Whether the tree is a single NullBsdf.
bool is_nothing(const MaterialTree& tree);

/// Whether any leaf has a normal or bump map; the same of its coat, and of all else.
bool is_bent(const MaterialTree& tree);
bool is_coat_bent(const MaterialTree& tree);
bool is_base_bent(const MaterialTree& tree);

/// Whether any leaf is one of OpenPBR's surfaces, whose coats may have normals of their own.
bool has_openpbr(const MaterialTree& tree);

/// Whether the tangent of any leaf is turned.
bool is_turned(const MaterialTree& tree);

/// The tree with `bend` applied to these layers of all leaves.
MaterialTree bent(const MaterialTree& tree, const SurfaceBend& bend, BentLayers layers = BentLayers::kAll);

/// Both sides bent by the same map: a normal that leans outwards on the front leans inwards on the back. The
/// two sides then always differ.
SurfaceMaterial bent(const SurfaceMaterial& material, const SurfaceBend& bend,
                     BentLayers layers = BentLayers::kAll);

/// The material with the tangents of all leaves turned.
SurfaceMaterial turned(const SurfaceMaterial& material, const SurfaceTurn& turn);

/// The material as it is on tubes of triangles: hair takes its offset from the normals, and light that has
/// passed a fibre leaves it without another surface.
SurfaceMaterial hair_of_tubes(const SurfaceMaterial& material);

/// The material as it is on round curves, of which only the outside is met: hair takes its offset from the
/// normals.
SurfaceMaterial hair_of_round_curves(const SurfaceMaterial& material);

/// Adds the BSDFs of trees to a scene. A shared subtree is added once.
class MaterialInstaller {
 public:
  /// Returns the index of the tree's root, which comes after its children.
  int add(const MaterialTree& tree, SceneDescription& scene);

  /// Adds both sides and returns their indices.
  std::pair<int, int> add(const SurfaceMaterial& material, SceneDescription& scene) {
    const int front = add(material.front, scene);
    return {front, add(material.back, scene)};
  }

 private:
  std::map<MaterialTree, int> installed_;
};

}  // namespace penumbra
