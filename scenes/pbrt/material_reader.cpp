#include "scenes/pbrt/material_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/pbrt/type_rows.h"
#include "scenes/refractive_indices.h"

namespace penumbra::pbrt {
namespace {

/// Below, pbrt's microfacets count as smooth.
constexpr float kSmooth = 1e-3f;

/// An opaque material looks alike from both sides.
SurfaceMaterial both_sides(const char* name, BsdfModel model) {
  const MaterialTree tree = leaf(name, std::move(model));
  return {tree, tree};
}

template <typename Surface>
void set_metal(Surface& surface, const char* name) {
  const ComplexIndex index = conductor_index(*conductor_names().parse(name));
  surface.eta = TexturedColour(index.eta);
  surface.k = TexturedColour(index.k);
}

}  // namespace

bool MaterialReader::Roughness::smooth() const {
  return u.texture == kNoTexture && v.texture == kNoTexture && std::max(u.value, v.value) < kSmooth;
}

std::shared_ptr<const SurfaceMaterial> MaterialReader::named(const std::string& name,
                                                             SourceLocation location) {
  const auto found = named_.find(name);
  if (found != named_.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [each, ignored] : named_) known.push_back(each);
  context_.report.error(location, fmt::format("there is no material '{}' before this{}", name,
                                              known_names(name, known, "There are")));
  return std::make_shared<SurfaceMaterial>(both_sides("missing", DiffuseBsdf{}));
}

std::shared_ptr<const SurfaceMaterial> MaterialReader::read(const std::string& type, Parameters& parameters,
                                                            SourceLocation location) {
  ReaderReport& report = context_.report;
  struct Reader {
    const char* type;
    SurfaceMaterial (MaterialReader::*read)(Parameters&, SourceLocation);
  };
  static constexpr Reader kReaders[] = {{"diffuse", &MaterialReader::diffuse},
                                        {"conductor", &MaterialReader::conductor},
                                        {"coateddiffuse", &MaterialReader::coated_diffuse},
                                        {"coatedconductor", &MaterialReader::coated_conductor},
                                        {"dielectric", &MaterialReader::dielectric},
                                        {"thindielectric", &MaterialReader::thin_dielectric},
                                        {"mix", &MaterialReader::mix}};
  if (type == "interface" || type.empty() || type == "none")
    return std::make_shared<SurfaceMaterial>(both_sides("interface", NullBsdf{}));
  const auto* found = find_row(kReaders, type, "material", "a magenta diffuse stands in for it", location,
                               report, {"interface"});
  if (found == nullptr)
    return std::make_shared<SurfaceMaterial>(both_sides(type.c_str(), DiffuseBsdf{kUnreadColour}));
  SurfaceMaterial material = (this->*found->read)(parameters, location);
  SurfaceBend bend;
  if (const std::string file = parameters.text("normalmap", "", report); !file.empty()) {
    if (const auto texture = textures_.normal_map(file, parameters.location("normalmap", location)))
      bend = {BendKind::kNormalMap, *texture};
  }
  if (const TexturedNumber bumps = textures_.number(parameters, "displacement", 0.0, -1e30, 1e30);
      bumps.texture != kNoTexture) {
    if (bend.kind != BendKind::kNone)
      report.warn(location, "a material has a normalmap or displacement; this normalmap is ignored");
    bend = {BendKind::kBumpMap, bumps.texture};
  }
  if (bend.kind != BendKind::kNone && !is_bent(material.front)) material = bent(material, bend);
  parameters.finish(fmt::format("the material '{}'", type), report);
  return std::make_shared<SurfaceMaterial>(std::move(material));
}

SurfaceMaterial MaterialReader::diffuse(Parameters& parameters, SourceLocation) {
  DiffuseBsdf model;
  model.reflectance = textures_.colour(parameters, "reflectance", ColourOf::kReflectance, glm::vec3(0.5f));
  return both_sides("diffuse", model);
}

/// alpha is the square root of what is given, unless `remaproughness` is false.
MaterialReader::Roughness MaterialReader::roughness(Parameters& parameters, const std::string& prefix,
                                                    SourceLocation location) {
  ReaderReport& report = context_.report;
  const bool remap = parameters.boolean("remaproughness", true, report);
  const TexturedNumber both = textures_.number(parameters, prefix + "roughness", 0.0, 0.0, 100.0);
  Roughness result{both, both};
  if (parameters.has(prefix + "uroughness"))
    result.u = textures_.number(parameters, prefix + "uroughness", 0.0, 0.0, 100.0);
  if (parameters.has(prefix + "vroughness"))
    result.v = textures_.number(parameters, prefix + "vroughness", 0.0, 0.0, 100.0);
  for (TexturedNumber* each : {&result.u, &result.v}) {
    if (each->texture == kNoTexture) {
      if (remap) each->value = std::sqrt(each->value);
    } else if (remap) {
      report.unsupported(location, "a texture of a roughness of which alpha is the square root is not read",
                         "alpha is 0.5");
      *each = TexturedNumber(0.5f);
    }
  }
  return result;
}

SurfaceMaterial MaterialReader::conductor_with(Parameters& parameters, const std::string& prefix,
                                               SourceLocation location) {
  RoughConductorBsdf model;
  set_metal(model, "Cu");
  if (parameters.has("reflectance")) {
    // eta 1 and the k with which as much is reflected along the normal: 2 sqrt(r) / sqrt(1 - r).
    const TexturedColour given =
        textures_.colour(parameters, "reflectance", ColourOf::kReflectance, glm::vec3(0.5f));
    if (given.texture != kNoTexture) {
      context_.report.warn_counted(
          parameters.location("reflectance", location),
          "a conductor whose reflectance is a texture reflects as much in all directions");
      model.eta = TexturedColour(glm::vec3(0.0f));
      model.k = TexturedColour(glm::vec3(1.0f));
      model.specular_reflectance = given;
    } else {
      glm::vec3 k;
      for (int c = 0; c < 3; ++c) {
        const float r = std::clamp(given.value[c], 0.0f, 0.9999f);
        k[c] = 2.0f * std::sqrt(r) / std::sqrt(1.0f - r);
      }
      model.eta = TexturedColour(glm::vec3(1.0f));
      model.k = TexturedColour(k);
    }
  }
  for (const auto& [name, field] : {std::pair(prefix + "eta", &model.eta), std::pair(prefix + "k", &model.k)})
    if (parameters.has(name)) *field = textures_.colour(parameters, name, ColourOf::kIndex, field->value);
  const Roughness rough = roughness(parameters, prefix, location);
  if (rough.smooth()) {
    ConductorBsdf smooth;
    static_cast<ConductorSurface&>(smooth) = model;
    return both_sides("conductor", smooth);
  }
  model.distribution = DISTRIBUTION_GGX;
  model.alpha_u = rough.u;
  model.alpha_v = rough.v;
  return both_sides("conductor", model);
}

SurfaceMaterial MaterialReader::conductor(Parameters& parameters, SourceLocation location) {
  return conductor_with(parameters, "", location);
}

SurfaceMaterial MaterialReader::coated_conductor(Parameters& parameters, SourceLocation location) {
  context_.report.warn_counted(location, "coatedconductor is approximated by the conductor without its coating");
  parameters.accept({"interface.eta", "interface.roughness", "interface.uroughness", "interface.vroughness",
                     "thickness", "g", "albedo", "maxdepth", "nsamples"});
  return conductor_with(parameters, "conductor.", location);
}

double MaterialReader::index(Parameters& parameters, SourceLocation location) {
  Parameter* eta = parameters.take("eta");
  if (eta == nullptr) return 1.5;
  double value = eta->numbers.size() == 1 ? eta->numbers[0] : 0.0;
  if (eta->type == "spectrum" && eta->texts.size() == 1) {
    const auto glass = glass_index(eta->texts[0]);
    if (!glass) {
      context_.report.unsupported(eta->location, fmt::format("'{}' is no glass that is known", eta->texts[0]),
                                  "its index is 1.5");
      return 1.5;
    }
    context_.report.warn_counted(eta->location, "glasses have one refractive index at all wavelengths");
    value = *glass;
  } else if (eta->type != "float") {
    context_.report.unsupported(eta->location, "a refractive index is a float or a named glass", "it is 1.5");
    return 1.5;
  }
  if (value >= 1e-3 && value <= 1e3) return value;
  context_.report.error(parameters.location("eta", location),
                        fmt::format("a refractive index must be in [0.001, 1000], not {}", value));
  return 1.5;
}

SurfaceMaterial MaterialReader::coated_diffuse(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  report.warn_counted(location,
                   "coateddiffuse is approximated by a plastic: diffuse under a boundary without thickness");
  parameters.accept({"thickness", "g", "albedo", "maxdepth", "nsamples", "twosided"});
  const TexturedColour colour =
      textures_.colour(parameters, "reflectance", ColourOf::kReflectance, glm::vec3(0.5f));
  const float eta = float(index(parameters, location));
  if (eta > kMostIndexRatio || eta < 1 / kMostIndexRatio || eta == 1.0f) {
    report.error(
        parameters.location("eta", location),
        fmt::format("the boundary of a coateddiffuse has an index other than 1 up to {}", kMostIndexRatio));
    return {};
  }
  const Roughness rough = roughness(parameters, "", location);
  if (rough.smooth()) {
    PlasticBsdf model;
    model.diffuse = colour;
    model.int_ior = eta;
    model.ext_ior = 1.0f;
    model.nonlinear = true;
    return both_sides("coateddiffuse", model);
  }
  RoughPlasticBsdf model;
  model.diffuse = colour;
  model.int_ior = eta;
  model.ext_ior = 1.0f;
  model.nonlinear = true;
  model.distribution = DISTRIBUTION_GGX;
  if (rough.u != rough.v)
    report.warn(location, "the boundary of a coateddiffuse is as rough in all directions");
  model.alpha = rough.u;
  if (rough.u.texture == kNoTexture && rough.v.texture == kNoTexture)
    model.alpha = TexturedNumber(std::sqrt(rough.u.value * rough.v.value));
  return both_sides("coateddiffuse", model);
}

SurfaceMaterial MaterialReader::dielectric(Parameters& parameters, SourceLocation location) {
  const float eta = float(index(parameters, location));
  const Roughness rough = roughness(parameters, "", location);
  if (rough.smooth()) {
    DielectricBsdf model;
    model.int_ior = eta;
    model.ext_ior = 1.0f;
    return surface_of("dielectric", model);
  }
  RoughDielectricBsdf model;
  model.int_ior = eta;
  model.ext_ior = 1.0f;
  model.distribution = DISTRIBUTION_GGX;
  model.alpha_u = rough.u;
  model.alpha_v = rough.v;
  return surface_of("dielectric", model);
}

SurfaceMaterial MaterialReader::thin_dielectric(Parameters& parameters, SourceLocation location) {
  ThinDielectricBsdf model;
  model.int_ior = float(index(parameters, location));
  model.ext_ior = 1.0f;
  return surface_of("thindielectric", model);
}

/// `amount` is the share of the second.
SurfaceMaterial MaterialReader::mix(Parameters& parameters, SourceLocation location) {
  const Parameter* names = parameters.take("materials");
  if (names == nullptr || names->texts.size() != 2) {
    context_.report.error(location, "a mix needs \"string materials\" with two names");
    return {};
  }
  BlendBsdf blend;
  blend.weight = textures_.number(parameters, "amount", 0.5, 0.0, 1.0);
  return blended("mix", blend, *named(names->texts[0], names->location),
                 *named(names->texts[1], names->location));
}

}  // namespace penumbra::pbrt
