// Materials as readers put them together: trees of BSDFs, which may share parts, for the two sides of a
// surface.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "scenes/scene_description.h"

namespace penumbra {

/// A BSDF of one side with those that it holds; none: black.
struct MaterialNode;
using MaterialTree = std::shared_ptr<const MaterialNode>;
struct MaterialNode {
  Bsdf bsdf;
  MaterialTree first, second;  ///< of a blend; of a mask the second
};

/// What each side of a surface is made of.
struct SurfaceMaterial {
  MaterialTree front, back;
};

/// A BSDF that holds no others.
MaterialTree leaf(std::string name, BsdfModel model);

/// A blend of two, or a mask of the second.
MaterialTree branch(std::string name, BsdfModel model, MaterialTree first, MaterialTree second);

/// Of one that stands by itself, with what it is seen from behind, if it can be.
SurfaceMaterial surface_of(const std::string& name, const BsdfModel& model);

/// The mask of what each side is made of, and the blend of two; sides that are alike stay so.
SurfaceMaterial masked(const std::string& name, const MaskBsdf& mask, const SurfaceMaterial& inside);
SurfaceMaterial blended(const std::string& name, const BlendBsdf& blend, const SurfaceMaterial& first,
                        const SurfaceMaterial& second);

/// Whether it is a NullBsdf.
bool is_nothing(const MaterialTree& tree);

/// Whether any leaf is bent.
bool is_bent(const MaterialTree& tree);

/// With leaves that are bent so.
MaterialTree bent(const MaterialTree& tree, const SurfaceBend& bend);

/// The same for both sides: what leans out in front leans in behind. Sides that are alike are so no more.
SurfaceMaterial bent(const SurfaceMaterial& material, const SurfaceBend& bend);

/// Makes BSDFs of a scene out of trees, each once.
class MaterialInstaller {
 public:
  /// The index of the BSDF, which follows those that it holds.
  int add(const MaterialTree& tree, SceneDescription& scene);

  /// Of both sides.
  std::pair<int, int> add(const SurfaceMaterial& material, SceneDescription& scene) {
    const int front = add(material.front, scene);
    return {front, add(material.back, scene)};
  }

 private:
  std::map<MaterialTree, int> installed_;
};

}  // namespace penumbra
