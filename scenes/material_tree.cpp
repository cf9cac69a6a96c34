#include "scenes/material_tree.h"

#include <optional>

namespace penumbra {
namespace {

MaterialTree tree_of(const std::string& name, const std::optional<BsdfModel>& model) {
  return model ? leaf(name, *model) : nullptr;
}

bool is_mask(const MaterialTree& tree) { return std::holds_alternative<MaskBsdf>(tree->bsdf.model); }
bool is_branch(const MaterialTree& tree) {
  return is_mask(tree) || std::holds_alternative<BlendBsdf>(tree->bsdf.model);
}

/// Whether any leaf's BSDF has the property.
template <typename Property>
bool any_leaf(const MaterialTree& tree, const Property& property) {
  if (tree == nullptr) return false;
  return is_branch(tree) ? any_leaf(tree->first, property) || any_leaf(tree->second, property)
                         : property(tree->bsdf);
}

}  // namespace

MaterialTree leaf(std::string name, BsdfModel model) {
  return std::make_shared<MaterialNode>(MaterialNode{{std::move(name), std::move(model), {}}, {}, {}});
}

MaterialTree branch(std::string name, BsdfModel model, MaterialTree first, MaterialTree second) {
  return std::make_shared<MaterialNode>(
      MaterialNode{{std::move(name), std::move(model), {}}, std::move(first), std::move(second)});
}

SurfaceMaterial surface_of(const std::string& name, const BsdfModel& model) {
  const MaterialTree front = leaf(name, model);
  return std::visit(
      [&](const auto& known) -> SurfaceMaterial {
        if constexpr (requires { std::remove_cvref_t<decltype(known)>::kSidesAreAlike; })
          return {front, front};
        else if constexpr (requires { known.other_side(); })
          return {front, tree_of(name, known.other_side())};
        else
          return {front, nullptr};
      },
      model);
}

SurfaceMaterial masked(const std::string& name, const MaskBsdf& mask, const SurfaceMaterial& inside) {
  const MaterialTree front = branch(name, mask, {}, inside.front);
  const bool same = inside.front == inside.back;
  return {front, same ? front : branch(name, mask, {}, inside.back)};
}

SurfaceMaterial blended(const std::string& name, const BlendBsdf& blend, const SurfaceMaterial& first,
                        const SurfaceMaterial& second) {
  const MaterialTree front = branch(name, blend, first.front, second.front);
  const bool same = first.front == first.back && second.front == second.back;
  const bool black = first.back == nullptr && second.back == nullptr;
  return {front, same ? front : black ? nullptr : branch(name, blend, first.back, second.back)};
}

SurfaceMaterial filled(const SurfaceMaterial& material, const InnerMedium& inside) {
  MaterialNode front = *material.front;
  front.bsdf.inside = inside;
  return {std::make_shared<MaterialNode>(std::move(front)), material.back};
}

bool is_nothing(const MaterialTree& tree) {
  return tree != nullptr && std::holds_alternative<NullBsdf>(tree->bsdf.model);
}

bool is_bent(const MaterialTree& tree) { return is_base_bent(tree) || is_coat_bent(tree); }

bool is_coat_bent(const MaterialTree& tree) {
  return any_leaf(
      tree, [](const Bsdf& bsdf) { return bsdf.coat_bend.value_or(bsdf.bend).kind != BendKind::kNone; });
}

bool is_base_bent(const MaterialTree& tree) {
  return any_leaf(tree, [](const Bsdf& bsdf) { return bsdf.bend.kind != BendKind::kNone; });
}

bool has_openpbr(const MaterialTree& tree) {
  return any_leaf(tree, [](const Bsdf& bsdf) { return std::holds_alternative<OpenPbrBsdf>(bsdf.model); });
}

bool is_turned(const MaterialTree& tree) {
  return any_leaf(tree, [](const Bsdf& bsdf) { return bsdf.turn.turns(); });
}

namespace {

/// The tree with `change` applied to the BSDFs of all leaves.
template <typename Change>
MaterialTree with_leaves(const MaterialTree& tree, const Change& change) {
  if (tree == nullptr || is_nothing(tree)) return tree;
  MaterialNode copy = *tree;
  if (is_branch(tree)) {
    copy.first = with_leaves(tree->first, change);
    copy.second = with_leaves(tree->second, change);
  } else {
    change(copy.bsdf);
  }
  return std::make_shared<MaterialNode>(std::move(copy));
}

/// The tree with each leaf of hair replaced by `fibre(hair)`; the same tree where there is none.
template <typename Fibre>
MaterialTree with_hair(const MaterialTree& tree, const Fibre& fibre) {
  if (tree == nullptr) return tree;
  MaterialNode copy = *tree;
  if (const auto* hair = std::get_if<HairBsdf>(&tree->bsdf.model)) {
    copy.bsdf.model = fibre(*hair);
    return std::make_shared<MaterialNode>(std::move(copy));
  }
  copy.first = with_hair(tree->first, fibre);
  copy.second = with_hair(tree->second, fibre);
  const bool same = copy.first == tree->first && copy.second == tree->second;
  return same ? tree : std::make_shared<MaterialNode>(std::move(copy));
}

}  // namespace

MaterialTree bent(const MaterialTree& tree, const SurfaceBend& bend, BentLayers layers) {
  return with_leaves(tree, [&](Bsdf& bsdf) {
    const bool coats = std::holds_alternative<OpenPbrBsdf>(bsdf.model);
    if (layers == BentLayers::kBase && coats && !bsdf.coat_bend) bsdf.coat_bend = SurfaceBend{};
    if (layers == BentLayers::kCoat && coats) bsdf.coat_bend = bend;
    if (layers != BentLayers::kCoat) bsdf.bend = bend;
  });
}

SurfaceMaterial turned(const SurfaceMaterial& material, const SurfaceTurn& turn) {
  const auto side = [&](const MaterialTree& tree) {
    return with_leaves(tree, [&](Bsdf& bsdf) { bsdf.turn = turn; });
  };
  const MaterialTree front = side(material.front);
  return {front, material.back == material.front ? front : side(material.back)};
}

SurfaceMaterial hair_of_tubes(const SurfaceMaterial& material) {
  const auto outside = [](HairBsdf hair) -> BsdfModel {
    hair.offset = HairBsdf::kFromNormal;
    return hair;
  };
  const auto inside = [](const HairBsdf&) -> BsdfModel { return NullBsdf{}; };
  return {with_hair(material.front, outside), with_hair(material.back, inside)};
}

SurfaceMaterial hair_of_round_curves(const SurfaceMaterial& material) {
  const auto fibre = [](HairBsdf hair) -> BsdfModel {
    hair.offset = HairBsdf::kFromNormal;
    return hair;
  };
  const MaterialTree front = with_hair(material.front, fibre);
  return {front, material.back == material.front ? front : with_hair(material.back, fibre)};
}

SurfaceMaterial bent(const SurfaceMaterial& material, const SurfaceBend& bend, BentLayers layers) {
  SurfaceBend behind = bend;
  behind.scale = -bend.scale;
  return {bent(material.front, bend, layers), bent(material.back, behind, layers)};
}

int MaterialInstaller::add(const MaterialTree& tree, SceneDescription& scene) {
  if (tree == nullptr) return kBlackBsdf;
  if (const auto known = installed_.find(tree); known != installed_.end()) return known->second;
  Bsdf bsdf = tree->bsdf;
  const auto inside = [&](const MaterialTree& child) {
    return is_nothing(child) ? kNoBsdf : add(child, scene);
  };
  if (auto* mask = std::get_if<MaskBsdf>(&bsdf.model)) mask->inside = inside(tree->second);
  if (auto* blend = std::get_if<BlendBsdf>(&bsdf.model)) {
    blend->first = inside(tree->first);
    blend->second = inside(tree->second);
  }
  scene.bsdfs.push_back(std::move(bsdf));
  const int index = int(scene.bsdfs.size()) - 1;
  installed_.emplace(tree, index);
  return index;
}

}  // namespace penumbra
