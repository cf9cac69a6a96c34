#include "scenes/mitsuba/material_reader.h"

#include <fmt/format.h>

#include <array>

namespace penumbra::mitsuba {
namespace {

template <typename Model>
BsdfModel read_bsdf(PluginReader& plugin) {
  Model model;
  plugin.read_parameters(model);
  return model;
}

/// What it is seen from behind, if it can be.
template <typename Model>
std::optional<BsdfModel> other_side(const Model& model) {
  if constexpr (requires { model.other_side(); }) return model.other_side();
  return std::nullopt;
}
template <typename Model>
constexpr bool sides_are_alike(const Model&) {
  return requires { Model::kSidesAreAlike; };
}

/// Of one that stands by itself.
SurfaceMaterial surface_of(Bsdf bsdf) {
  SurfaceMaterial result;
  result.same = std::visit([](const auto& model) { return sides_are_alike(model); }, bsdf.model);
  const auto back = std::visit([](const auto& model) { return other_side(model); }, bsdf.model);
  if (back) result.back = Bsdf{bsdf.name, *back};
  if (result.same) result.back = bsdf;
  result.front = std::move(bsdf);
  return result;
}

struct BsdfPlugin {
  std::string_view type;
  BsdfModel (*read)(PluginReader&);
};
template <typename... Models>
constexpr auto bsdf_plugins(const std::variant<Models...>*) {
  return std::array{BsdfPlugin{Models::kPlugin, read_bsdf<Models>}...};
}
constexpr auto kBsdfs = bsdf_plugins(static_cast<const BsdfModel*>(nullptr));
// One that holds others.
constexpr std::string_view kTwoSided = "twosided";

}  // namespace

const SurfaceMaterial& MaterialReader::read(const Object& bsdf) {
  const auto known = materials_.find(&bsdf);
  if (known != materials_.end()) return known->second;
  if (!reading_.insert(&bsdf).second) {
    context_.diagnostics.error(bsdf.location,
                               fmt::format("bsdf '{}' holds itself, through its references", name_of(bsdf)));
    static const SurfaceMaterial kNothing;
    return kNothing;
  }
  SurfaceMaterial material = read_new(bsdf);
  reading_.erase(&bsdf);
  return materials_.emplace(&bsdf, std::move(material)).first->second;
}

SurfaceMaterial MaterialReader::read_new(const Object& bsdf) {
  PluginReader plugin(context_, bsdf);
  SurfaceMaterial result;
  if (const auto* known = find_plugin(kBsdfs, bsdf.type)) {
    result = surface_of(Bsdf{name_of(bsdf), known->read(plugin)});
  } else if (bsdf.type == kTwoSided) {
    result = read_two_sided(plugin);
  } else {
    std::vector<std::string> types = plugin_types(kBsdfs);
    types.emplace_back(kTwoSided);
    context_.unknown_plugin(bsdf, types, "a magenta diffuse stands in for it");
    result.front = Bsdf{name_of(bsdf), DiffuseBsdf{kStandInColour}};
    plugin.skip();
  }
  plugin.finish();
  return result;
}

SurfaceMaterial MaterialReader::read_two_sided(PluginReader& plugin) {
  const std::vector<const Object*> nested = plugin.nested("bsdf");
  SurfaceMaterial result;
  if (nested.empty() || nested.size() > 2) {
    plugin.wrong(
        fmt::format("a twosided bsdf holds one bsdf (for both sides) or two, not {}", nested.size()));
    return result;
  }
  for (const Object* side : nested) {
    if (side->type == kTwoSided) {
      plugin.wrong("a twosided bsdf cannot hold another twosided one");
      return result;
    }
  }
  for (const Object* side : nested)
    if (read(*side).back) {
      plugin.wrong(fmt::format("a twosided bsdf cannot hold '{}', which lets light through", side->type));
      return {};
    }
  result.front = read(*nested[0]).front;
  result.back = nested.size() == 2 ? read(*nested[1]).front : result.front;
  result.same = nested.size() == 1;
  return result;
}

std::pair<int, int> MaterialReader::install(const Object* bsdf, bool emits, SceneDescription& scene) {
  if (bsdf == nullptr && emits) return {kBlackBsdf, kBlackBsdf};
  const auto known = installed_.find(bsdf);
  if (known != installed_.end()) return known->second;
  static const SurfaceMaterial kDefault{Bsdf{"default", DiffuseBsdf{}}, std::nullopt, false};
  const SurfaceMaterial& material = bsdf != nullptr ? read(*bsdf) : kDefault;
  const auto add = [&](const std::optional<Bsdf>& side) {
    if (!side) return kBlackBsdf;
    scene.bsdfs.push_back(*side);
    return int(scene.bsdfs.size()) - 1;
  };
  const int front = add(material.front);
  const std::pair<int, int> indices(front, material.same ? front : add(material.back));
  installed_.emplace(bsdf, indices);
  return indices;
}

}  // namespace penumbra::mitsuba
