#include "scenes/mitsuba/material_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <type_traits>

#include "scenes/bsdfs/coating.h"
#include "scenes/mitsuba/texture_reader.h"
#include "scenes/number.h"

namespace penumbra::mitsuba {
namespace {

/// lajolla gives its rough BSDFs a roughness, whose square is alpha, and has GGX microfacets only. Mitsuba
/// has no such parameter, and ignores it.
template <typename Model>
void read_lajolla_roughness(PluginReader& plugin, Model& model) {
  if (!plugin.is_of_version_0() || !plugin.has("roughness")) return;
  if (plugin.has("alpha") || plugin.has("alpha_u") || plugin.has("alpha_v") || plugin.has_nested("alpha"))
    return;
  const double roughness = plugin.number("roughness", 0.0);
  if (!(roughness >= 0.0 && roughness <= 1.0))
    return plugin.wrong("roughness", fmt::format("roughness must be in [0, 1], not {}", roughness));
  plugin.warn("the roughness is lajolla's, the square root of alpha; Mitsuba has none");
  model.alpha = TexturedNumber(float(roughness * roughness));
  model.distribution = DISTRIBUTION_GGX;
}

template <typename Model>
BsdfModel read_bsdf(PluginReader& plugin) {
  Model model;
  if constexpr (std::is_same_v<Model, RoughPlasticBsdf> || std::is_same_v<Model, RoughDielectricBsdf>)
    read_lajolla_roughness(plugin, model);
  plugin.read_parameters(model);
  return model;
}

struct BsdfPlugin {
  std::string_view type;
  BsdfModel (*read)(PluginReader&);
};
/// Plugins without nested BSDFs. Those in MaterialReader::holders() are read there.
template <typename... Models>
constexpr auto bsdf_plugins(const std::variant<Models...>*) {
  return std::array{BsdfPlugin{Models::kPlugin, read_bsdf<Models>}...};
}
constexpr auto kBsdfs = bsdf_plugins(static_cast<const BsdfModel*>(nullptr));
constexpr std::string_view kTwoSided = "twosided";

/// BSDFs of Mitsuba and its relatives that are not supported, and what to use instead.
struct UnreadBsdf {
  std::string_view type, words;
};
constexpr UnreadBsdf kUnreadBsdfs[] = {
    {"torrance",
     "its diffuse part is not dimmed by the reflection above it; a 'roughplastic' of the same parameters is "
     "nearest"},
    {"disneytransmission", "lajolla has left it out; 'disneyglass' took its place"},
    {"measured_polarized",
     "light has no polarisation; a 'measured' of the same material, a 'roughconductor' or a 'principled' "
     "with "
     "its colour and roughness is nearest"}};

}  // namespace

/// A plugin that holds BSDFs or has no BSDF model.
struct MaterialReader::Holder {
  std::string_view type;
  SurfaceMaterial (MaterialReader::*read)(PluginReader&);
};

const std::vector<MaterialReader::Holder>& MaterialReader::holders() {
  static const std::vector<Holder> all = {
      {kTwoSided, &MaterialReader::read_two_sided},
      {NullBsdf::kPlugin, &MaterialReader::read_null},
      {MaskBsdf::kPlugin, &MaterialReader::read_mask},
      {BlendBsdf::kPlugin, &MaterialReader::read_blend},
      {"mixturebsdf", &MaterialReader::read_mixture},
      {MetalRoughParameters::kPlugin, &MaterialReader::read_metal_rough},
      {StandardSurfaceParameters::kPlugin, &MaterialReader::read_standard_surface},
      {MeasuredBsdf::kPlugin, &MaterialReader::read_measured},
      {PolarizerParameters::kPlugin, &MaterialReader::read_polarizer},
      {"circular", &MaterialReader::read_polarizer},
      {"retarder", &MaterialReader::read_polarizer},
      {CoatingParameters::kPlugin, &MaterialReader::read_coating},
      {RoughCoatingParameters::kPlugin, &MaterialReader::read_coating},
      {DisneyDiffuseParameters::kPlugin, &MaterialReader::read_lajolla<DisneyDiffuseParameters>},
      {DisneyMetalParameters::kPlugin, &MaterialReader::read_lajolla<DisneyMetalParameters>},
      {DisneyClearcoatParameters::kPlugin, &MaterialReader::read_lajolla<DisneyClearcoatParameters>},
      {DisneySheenParameters::kPlugin, &MaterialReader::read_lajolla<DisneySheenParameters>},
      {DisneyGlassParameters::kPlugin, &MaterialReader::read_lajolla<DisneyGlassParameters>},
      {DisneySumParameters::kPlugin, &MaterialReader::read_lajolla<DisneySumParameters>},
      {"normalmap", &MaterialReader::read_normal_map},
      {"bumpmap", &MaterialReader::read_bump_map},
      {TurnedTangentParameters::kPlugin, &MaterialReader::read_turned},
      // The name in Mitsuba 0.5.
      {"bump", &MaterialReader::read_bump_map}};
  return all;
}

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
  // The short names are lajolla's, too.
  const bool may_be_short = bsdf.type == DisneySumParameters::kPlugin;
  const Object in_full =
      may_be_short ? renamed(bsdf, {{"spec_trans", "specular_transmission"}, {"spec_tint", "specular_tint"}})
                   : Object{};
  PluginReader plugin(context_, may_be_short ? in_full : bsdf);
  SurfaceMaterial result;
  if (const auto* holder = find_plugin(holders(), bsdf.type)) {
    result = (this->*holder->read)(plugin);
  } else if (const auto* known = find_plugin(kBsdfs, bsdf.type)) {
    result = surface_of(name_of(bsdf), known->read(plugin));
  } else if (const auto* unread = find_plugin(kUnreadBsdfs, bsdf.type)) {
    context_.unsupported(
        bsdf.type_location,
        fmt::format("bsdf type '{}' is not one that Penumbra reads: {}", bsdf.type, unread->words),
        "a magenta diffuse stands in for it");
    result.front = leaf(name_of(bsdf), DiffuseBsdf{kPlaceholderColour});
    plugin.skip();
  } else {
    std::vector<std::string> types = plugin_types(kBsdfs);
    for (const Holder& each : holders())
      if (std::ranges::find(types, each.type) == types.end()) types.emplace_back(each.type);
    context_.unknown_plugin(bsdf, types, "a magenta diffuse stands in for it");
    result.front = leaf(name_of(bsdf), DiffuseBsdf{kPlaceholderColour});
    plugin.skip();
  }
  plugin.finish();
  return result;
}

/// Reads the nested BSDFs, of which there must be `count`; otherwise none, and an error.
std::vector<const SurfaceMaterial*> MaterialReader::read_nested(PluginReader& plugin, std::size_t count) {
  const std::vector<const Object*> nested = plugin.nested("bsdf");
  std::vector<const SurfaceMaterial*> result;
  if (nested.size() != count) {
    plugin.wrong(fmt::format("{} holds {}, not {}", plugin.title(),
                             count == 1 ? "one bsdf" : fmt::format("{} bsdfs", count), nested.size()));
    return result;
  }
  for (const Object* each : nested) result.push_back(&read(*each));
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
    // Of another twosided one the front is seen from both sides.
    const bool may_have_two = side->type == kTwoSided || side->type == CoatingParameters::kPlugin ||
                              side->type == RoughCoatingParameters::kPlugin;
    if (read(*side).back != nullptr && !may_have_two) {
      plugin.wrong(fmt::format(
          "a twosided bsdf cannot hold '{}', which lets light through or has two sides already", side->type));
      return result;
    }
  }
  result.front = read(*nested[0]).front;
  result.back = nested.size() == 2 ? read(*nested[1]).front : result.front;
  return result;
}

SurfaceMaterial MaterialReader::read_null(PluginReader& plugin) {
  const MaterialTree nothing = leaf(name_of(plugin.object()), read_bsdf<NullBsdf>(plugin));
  return {nothing, nothing};
}

SurfaceMaterial MaterialReader::read_mask(PluginReader& plugin) {
  MaskBsdf model;
  plugin.read_parameters(model);
  const auto inside = read_nested(plugin, 1);
  if (inside.empty()) return {};
  return masked(name_of(plugin.object()), model, *inside[0]);
}

SurfaceMaterial MaterialReader::read_blend(PluginReader& plugin) {
  BlendBsdf model;
  plugin.read_parameters(model);
  const auto inside = read_nested(plugin, 2);
  if (inside.empty()) return {};
  return blended(name_of(plugin.object()), model, *inside[0], *inside[1]);
}

SurfaceMaterial MaterialReader::read_metal_rough(PluginReader& plugin) {
  MetalRoughParameters surface;
  plugin.read_parameters(surface);
  if (surface.ior == 0.0f && surface.specular_color.texture != kNoTexture) {
    plugin.wrong("specular_color", "the specular_color is a number, not a texture, where ior is 0");
    return {};
  }
  return surface_of(name_of(plugin.object()), surface.as_openpbr());
}

SurfaceMaterial MaterialReader::read_standard_surface(PluginReader& plugin) {
  StandardSurfaceParameters surface;
  plugin.read_parameters(surface);
  if (surface.base_color.texture != kNoTexture && surface.coat.value > 0.0f &&
      surface.coat_color != TexturedColour(glm::vec3(1.0f)))
    plugin.warn("a base_color that is a texture is not dimmed by coat_color, as another is");
  const SurfaceMaterial whole = surface_of(name_of(plugin.object()), surface.as_openpbr());
  if (surface.opacity == TexturedNumber(1.0f)) return whole;
  MaskBsdf mask;
  mask.opacity = surface.opacity;
  return masked(name_of(plugin.object()), mask, whole);
}

SurfaceMaterial MaterialReader::read_measured(PluginReader& plugin) {
  MeasuredBsdf model;
  plugin.read_parameters(model);
  if (!plugin.has("filename")) {
    plugin.wrong(fmt::format("{} needs a <string name=\"filename\" …>", plugin.title()));
    return {};
  }
  const auto path = context_.files->find(model.filename, context_.folders(plugin.object()));
  auto brdf = path ? measured_.read(*context_.files, *path) : std::unexpected(path.error());
  if (!brdf) {
    plugin.wrong("filename", brdf.error().message);
    return {};
  }
  model.filename = path->string();
  model.brdf = std::move(*brdf);
  return surface_of(name_of(plugin.object()), std::move(model));
}

SurfaceMaterial MaterialReader::read_polarizer(PluginReader& plugin) {
  PolarizerParameters filter;
  plugin.read_parameters(filter);
  // Parameters that affect only the polarisation.
  plugin.accept({"theta", "delta", "polarizing", "left_handed"});
  if (filter.transmittance.texture != kNoTexture) {
    plugin.wrong("transmittance", "the transmittance of a polariser is a number, not a texture");
    return {};
  }
  const float through = plugin.object().type == "retarder" ? 1.0f : 0.5f;
  return masked(name_of(plugin.object()), MaskBsdf{1.0f - through * filter.transmittance.value}, {});
}

SurfaceMaterial MaterialReader::read_coating(PluginReader& plugin) {
  const bool is_rough = plugin.object().type == RoughCoatingParameters::kPlugin;
  RoughCoatingParameters coating;
  if (is_rough)
    plugin.read_parameters(coating);
  else
    plugin.read_parameters(static_cast<CoatingParameters&>(coating));
  plugin.accept({"sigma_a", "thickness"});
  const auto inside = read_nested(plugin, 1);
  if (inside.empty()) return {};
  plugin.warn(
      "the coating is approximated by a blend with a mirror, which reflects as much as it does on the whole; "
      "it absorbs nothing");
  RoughConductorBsdf mirror;
  mirror.specular_reflectance = coating.specular;
  static_cast<RoughSurface&>(mirror) = coating;
  const std::string name = name_of(plugin.object());
  const MaterialTree surface = leaf(
      name, is_rough ? BsdfModel(mirror) : BsdfModel(ConductorBsdf{static_cast<ConductorSurface&>(mirror)}));
  const double reflected = smooth_external_reflectance(double(coating.int_ior) / double(coating.ext_ior));
  return blended(name, BlendBsdf{TexturedNumber(float(reflected))}, *inside[0],
                 {surface, inside[0]->back != nullptr ? surface : nullptr});
}

/// The BSDFs of lajolla, see bsdfs/lajolla.h.
template <typename Parameters>
SurfaceMaterial MaterialReader::read_lajolla(PluginReader& plugin) {
  Parameters given;
  plugin.read_parameters(given);
  plugin.accept({"eta"});  // its scenes give one to lobes that have none
  const std::string name = name_of(plugin.object());
  const SurfaceMaterial surface = surface_of(name, given.model());
  if constexpr (requires { given.transmission(); }) {
    if (const float share = given.transmission(); share > 0.0f) {
      const SurfaceMaterial glass = surface_of(name, given.glass().model());
      return share < 1.0f ? blended(name, BlendBsdf{TexturedNumber(share)}, surface, glass) : glass;
    }
  }
  return surface;
}

/// Of Mitsuba 0.5 and 0.6: any number, each with its weight; what is missing to 1 is black.
SurfaceMaterial MaterialReader::read_mixture(PluginReader& plugin) {
  MixtureParameters mixture;
  plugin.read_parameters(mixture);
  const Expected<std::vector<double>> parsed = parse_numbers(mixture.weights);
  if (!parsed) {
    plugin.wrong("weights", fmt::format("weights: {}", parsed.error().message));
    return {};
  }
  const std::vector<double>& weights = *parsed;
  for (const double weight : weights) {
    if (weight >= 0.0 && weight <= 1.0) continue;
    plugin.wrong("weights", fmt::format("weights must be in [0, 1], not {}", weight));
    return {};
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (sum > 1.0 + 1e-6) {
    plugin.wrong("weights", fmt::format("weights add up to {}, more than 1", sum));
    return {};
  }
  if (weights.empty()) {
    plugin.wrong("weights",
                 fmt::format("{} needs weights, a number for each bsdf that it holds", plugin.title()));
    return {};
  }
  const auto inside = read_nested(plugin, weights.size());
  if (inside.empty()) return {};
  // Builds a chain of blends from the last BSDF on: the first weight against all following ones, and so on.
  const std::string name = name_of(plugin.object());
  SurfaceMaterial rest;
  double before = 1.0 - sum;
  for (std::size_t i = inside.size(); i-- > 0;) {
    const double all = before + weights[i];
    const float weight = all > 0.0 ? float(std::min(weights[i] / all, 1.0)) : 0.0f;
    rest.front = branch(name, BlendBsdf{weight}, rest.front, inside[i]->front);
    if (rest.back != nullptr || inside[i]->back != nullptr)
      rest.back = branch(name, BlendBsdf{weight}, rest.back, inside[i]->back);
    before = all;
  }
  return rest;
}

template <typename Parameters>
SurfaceMaterial MaterialReader::read_bent(PluginReader& plugin, Parameters parameters, SurfaceBend bend) {
  plugin.read_parameters(parameters);
  // Only Mitsuba 3's treatment of normals that face away is supported.
  if (!parameters.flip_invalid_normals)
    plugin.warn("normals that face away from the viewer lean the other way all the same");
  bend.shadows = parameters.use_shadowing_function;
  if constexpr (requires { parameters.scale; }) bend.scale = parameters.scale;
  const BentLayers layers = parameters.layers;
  const std::vector<const Object*> textures = plugin.nested("texture");
  const auto inside = read_nested(plugin, 1);
  if (textures.size() != 1) {
    plugin.wrong(fmt::format("{} holds one texture, not {}", plugin.title(), textures.size()));
    return {};
  }
  const std::optional<int> texture = context_.textures->read(*textures[0]);
  if (inside.empty() || !texture) return {};
  const auto again = [&](const MaterialTree& tree) {
    return (layers != BentLayers::kCoat && is_base_bent(tree)) ||
           (layers != BentLayers::kBase && is_coat_bent(tree));
  };
  if (again(inside[0]->front) || again(inside[0]->back)) {
    plugin.wrong(fmt::format("{} cannot hold another normalmap or bumpmap{}", plugin.title(),
                             layers == BentLayers::kAll ? "" : " of the same layer"));
    return {};
  }
  if (layers == BentLayers::kCoat && !has_openpbr(inside[0]->front)) {
    plugin.wrong(
        fmt::format("{} holds no openpbr: others have no coat with normals of its own", plugin.title()));
    return {};
  }
  bend.texture = *texture;
  return bent(*inside[0], bend, layers);
}

SurfaceMaterial MaterialReader::read_normal_map(PluginReader& plugin) {
  return read_bent(plugin, NormalMapParameters{}, {BendKind::kNormalMap});
}

SurfaceMaterial MaterialReader::read_bump_map(PluginReader& plugin) {
  return read_bent(plugin, BumpMapParameters{}, {BendKind::kBumpMap});
}

SurfaceMaterial MaterialReader::read_turned(PluginReader& plugin) {
  TurnedTangentParameters parameters;
  plugin.read_parameters(parameters);
  SurfaceTurn turn{.angle = glm::radians(parameters.angle), .mirrored = parameters.mirrored};
  const std::vector<const Object*> textures = plugin.nested("texture");
  const auto inside = read_nested(plugin, 1);
  if (textures.size() > 1) {
    plugin.wrong(fmt::format("{} holds at most one texture, not {}", plugin.title(), textures.size()));
    return {};
  }
  if (!textures.empty()) {
    const std::optional<int> texture = context_.textures->read(*textures[0]);
    if (!texture) return {};
    turn.texture = *texture;
  }
  return inside.empty() ? SurfaceMaterial{} : turned(*inside[0], turn);
}

std::string MaterialReader::id_of(const Object* bsdf) const {
  for (std::set<const Object*> met; bsdf != nullptr && met.insert(bsdf).second;) {
    if (!bsdf->id.empty()) return bsdf->id;
    const Object* inside = nullptr;
    for (const Child& child : bsdf->children) {
      const Object* held = context_.resolve(child);
      if (inside == nullptr && held != nullptr && held->tag == "bsdf") inside = held;
    }
    bsdf = inside;
  }
  return {};
}

std::pair<int, int> MaterialReader::install(const Object* bsdf, const Shape& shape, SceneDescription& scene,
                                            bool is_tube) {
  const auto* curves = std::get_if<Curves>(&shape.geometry);
  const bool is_round = curves != nullptr && !is_ribbon(curves->form);
  if (bsdf != nullptr && (is_tube || is_round)) {
    const auto [known, is_new] = (is_tube ? of_tubes_ : of_curves_).try_emplace(bsdf);
    if (is_new) known->second = is_tube ? hair_of_tubes(read(*bsdf)) : hair_of_round_curves(read(*bsdf));
    return installer_.add(known->second, scene);
  }
  if (bsdf != nullptr) return installer_.add(read(*bsdf), scene);
  if (shape.radiance) return {kBlackBsdf, kBlackBsdf};
  static const SurfaceMaterial kDefault{leaf("default", DiffuseBsdf{}), nullptr};
  static const MaterialTree kNothing = leaf("default", NullBsdf{});
  const bool parts_media = shape.interior != kNoMedium || shape.exterior != kNoMedium;
  if (parts_media && context_.tree.major_version < 2) return installer_.add({kNothing, kNothing}, scene);
  return installer_.add(kDefault, scene);
}

}  // namespace penumbra::mitsuba
