#include "scenes/pbrt/material_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/bsdf/fresnel.h"
#include "scenes/bsdfs/half_space.h"
#include "scenes/bsdfs/rough_boundary.h"
#include "scenes/pbrt/state.h"
#include "scenes/refractive_indices.h"
#include "scenes/scattering.h"

namespace penumbra::pbrt {
namespace {

/// Below this alpha, pbrt treats microfacets as smooth.
constexpr float kSmooth = 1e-3f;

/// An opaque material is the same on both sides.
SurfaceMaterial both_sides(const char* name, BsdfModel model) {
  const MaterialTree tree = leaf(name, std::move(model));
  return {tree, tree};
}

void set_metal(ConductorSurface& surface, const char* name) {
  const ComplexIndex index = metal_index(*conductor_names().parse(name));
  surface.eta = TexturedColour(index.eta);
  surface.k = TexturedColour(index.k);
}

/// The reflectance under a coating between which and it light goes to and fro for ever, as in our plastic,
/// that reflects as much as one of `reflectance` in pbrt. There, light meets one of the two surfaces `depth`
/// times at most, the lower one first: of the series sum (reflectance f)^i, where the coating reflects f of
/// the light from below, the first (depth + 1) / 2 terms are left.
double cut_interreflection(double reflectance, double f, int depth) {
  const double ratio = reflectance * f;
  const double cut = reflectance * (1.0 - std::pow(ratio, (depth + 1) / 2)) / (1.0 - ratio);
  return cut / (1.0 + f * cut);
}

}  // namespace

bool MaterialReader::Roughness::smooth() const {
  return u.texture == kNoTexture && v.texture == kNoTexture && std::max(u.value, v.value) < kSmooth;
}

int MaterialReader::declare(std::string type, Parameters parameters, SourceLocation location) {
  entries_.push_back(std::make_unique<Entry>(
      Entry{std::move(type), std::move(parameters), location, false, false, nullptr}));
  return int(entries_.size()) - 1;
}

void MaterialReader::declare_named(const std::string& name, std::string type, Parameters parameters,
                                   SourceLocation location) {
  if (!named_.try_emplace(name, int(entries_.size())).second)
    context_.report.error(location, fmt::format("the material '{}' is there twice", name));
  declare(std::move(type), std::move(parameters), location);
}

int MaterialReader::refer(const std::string& name, SourceLocation location) {
  const int number = declare(name, {}, location);
  entries_.back()->is_reference = true;
  return number;
}

void MaterialReader::finish() {
  for (int i = 0; i < int(entries_.size()) && !context_.report.full(); ++i) material(i);
}

std::shared_ptr<const SurfaceMaterial> MaterialReader::material(int number) {
  static const auto kDefault = std::make_shared<const SurfaceMaterial>(both_sides("default", DiffuseBsdf{}));
  if (number == kDefaultMaterial) return kDefault;
  Entry& entry = *entries_[std::size_t(number)];
  if (entry.material != nullptr) return entry.material;
  if (entry.is_begun) {
    context_.report.error(entry.location, "this material mixes itself");
    return kDefault;
  }
  entry.is_begun = true;
  entry.material = entry.is_reference ? named(entry.type, entry.location)
                                      : read(entry.type, entry.parameters, entry.location);
  entry.parameters = {};
  return entry.material;
}

std::shared_ptr<const SurfaceMaterial> MaterialReader::named(const std::string& name,
                                                             SourceLocation location) {
  const auto found = named_.find(name);
  if (found != named_.end()) return material(found->second);
  std::vector<std::string> known;
  for (const auto& [each, ignored] : named_) known.push_back(each);
  context_.report.error(
      location, fmt::format("there is no material '{}'{}", name, known_names(name, known, "There are")));
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
                                        {"diffusetransmission", &MaterialReader::diffuse_transmission},
                                        {"subsurface", &MaterialReader::subsurface},
                                        {"hair", &MaterialReader::hair},
                                        {"measured", &MaterialReader::measured},
                                        {"mix", &MaterialReader::mix}};
  if (type == "interface" || type.empty() || type == "none")
    return std::make_shared<SurfaceMaterial>(both_sides("interface", NullBsdf{}));
  const auto* found = find_row(kReaders, type, "material", "a magenta diffuse stands in for it", location,
                               report, {"interface"});
  if (found == nullptr)
    return std::make_shared<SurfaceMaterial>(both_sides(type.c_str(), DiffuseBsdf{kUnreadColour}));
  SurfaceMaterial material = (this->*found->read)(parameters, location);
  SurfaceBend bend;  // whose bumps cast no shadows on each other in pbrt
  if (const std::string file = parameters.text("normalmap", "", report); !file.empty()) {
    if (const auto texture = textures_.normal_map(file, parameters.location("normalmap", location)))
      bend = {.kind = BendKind::kNormalMap, .texture = *texture, .shadows = false};
  }
  if (const TexturedNumber bumps = textures_.number(parameters, "displacement", 0.0, -1e30, 1e30);
      bumps.texture != kNoTexture) {
    if (bend.kind != BendKind::kNone)
      report.warn(location, "a material has a normalmap or displacement; this normalmap is ignored");
    bend = {.kind = BendKind::kBumpMap, .texture = bumps.texture, .shadows = false};
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

/// alpha is the square root of the given roughness, unless `remaproughness` is false.
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
      const auto alpha = textures_.square_root(each->texture);
      if (!alpha)
        report.unsupported(location,
                           "a texture of a roughness, of which alpha is the square root, is read where it is "
                           "an image or a checkerboard, scaled or not",
                           "alpha is 0.5");
      *each = TexturedNumber(alpha ? 1.0f : 0.5f);
      each->texture = alpha.value_or(kNoTexture);
    }
  }
  return result;
}

SurfaceMaterial MaterialReader::metal_of(const ConductorSurface& metal, const Roughness& rough) {
  if (rough.smooth()) {
    ConductorBsdf smooth;
    static_cast<ConductorSurface&>(smooth) = metal;
    return both_sides("conductor", smooth);
  }
  RoughConductorBsdf model;
  static_cast<ConductorSurface&>(model) = metal;
  model.distribution = DISTRIBUTION_GGX;
  model.alpha_u = rough.u;
  model.alpha_v = rough.v;
  return both_sides("conductor", model);
}

ConductorSurface MaterialReader::conductor_surface(Parameters& parameters, const std::string& prefix,
                                                   SourceLocation location) {
  ConductorSurface model;
  set_metal(model, "Cu");
  if (parameters.has("reflectance")) {
    // Use eta 1 and the k that gives this reflectance at normal incidence: 2 sqrt(r) / sqrt(1 - r).
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
  return model;
}

SurfaceMaterial MaterialReader::conductor(Parameters& parameters, SourceLocation location) {
  const ConductorSurface surface = conductor_surface(parameters, "", location);
  return metal_of(surface, roughness(parameters, "", location));
}

double MaterialReader::coating_depth(Parameters& parameters, SourceLocation location) {
  const TexturedColour albedo =
      textures_.colour(parameters, "albedo", ColourOf::kReflectance, glm::vec3(0.0f));
  const TexturedNumber thickness = textures_.number(parameters, "thickness", 0.01, 0.0, 1e6);
  if (albedo.is_lit())
    context_.report.warn_counted(location, "the medium of a coating scatters nothing and absorbs the rest");
  if (thickness.texture != kNoTexture)
    context_.report.warn_counted(location, "the thickness of a coating has no texture; it is 0.01");
  const float scattered =
      albedo.texture == kNoTexture ? glm::dot(albedo.value, glm::vec3(1.0f / 3.0f)) : 0.5f;
  return (thickness.texture == kNoTexture ? double(thickness.value) : 0.01) *
         std::max(1.0 - double(scattered), 0.0);
}

/// An OpenPBR coat over a metal of the same reflectance along the normal and at the cosine 1 / 7.
SurfaceMaterial MaterialReader::coated_conductor(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  parameters.accept({"g", "maxdepth", "nsamples"});
  const double optical_depth = coating_depth(parameters, location);
  const double eta = std::clamp(index(parameters, "interface.eta", location), 1.0 / kMostIndexRatio,
                                double(kMostIndexRatio));
  const Roughness rough = roughness(parameters, "interface.", location);
  const ConductorSurface metal = conductor_surface(parameters, "conductor.", location);
  const Roughness below = roughness(parameters, "conductor.", location);
  if (eta < 1.0)
    report.warn_counted(location, "a coatedconductor whose coating has an index below 1 is read without it");
  if (eta <= 1.0) return metal_of(metal, below);
  report.warn_counted(location,
                      "coatedconductor is approximated by an openpbr: a coating over a metal with two "
                      "reflectances");
  OpenPbrBsdf surface;
  surface.coat_weight = 1.0f;
  surface.coat_ior = float(eta);
  surface.coat_color = glm::vec3(float(std::exp(-2.0 * optical_depth)));
  surface.base_metalness = 1.0f;
  for (int c = 0; c < 3; ++c) {
    const double n = double(metal.eta.value[c]) / eta, k = double(metal.k.value[c]) / eta;
    const double along = double(conductor_reflectance(1.0f, float(n), float(k)));
    const double aside = double(conductor_reflectance(1.0f / 7.0f, float(n), float(k)));
    const double schlick = along + (1.0 - along) * std::pow(6.0 / 7.0, 5);
    surface.base_color.value[c] = float(along);
    surface.specular_color.value[c] = float(std::min(aside / schlick, 1.0));
  }
  if (metal.specular_reflectance.texture != kNoTexture) {
    surface.base_color = metal.specular_reflectance;
    surface.specular_color = glm::vec3(1.0f);
  } else if (metal.eta.texture != kNoTexture || metal.k.texture != kNoTexture) {
    report.warn_counted(location,
                        "the indices of a coatedconductor have no textures; their factors are used");
  }
  const auto root = [&](TexturedNumber alpha) {
    alpha.value = std::min(std::sqrt(alpha.value), 1.0f);
    if (alpha.texture == kNoTexture) return alpha;
    const auto texture = textures_.square_root(alpha.texture);
    if (!texture)
      report.warn_counted(location, "a coatedconductor has textures of roughness that are images; it is 0.7");
    TexturedNumber result(texture ? 1.0f : 0.7f);
    result.texture = texture.value_or(kNoTexture);
    return result;
  };
  if (rough.u != rough.v)
    report.warn(location, "the coating of a coatedconductor is as rough in all directions");
  surface.coat_roughness = root(rough.u);
  surface.specular_roughness = root(below.u);
  if (below.u.texture == kNoTexture && below.v.texture == kNoTexture) {
    const double u = std::min(double(below.u.value), 1.0), v = std::min(double(below.v.value), 1.0);
    if (v < u) {
      const OpenPbrRoughness both = along_and_across(u, v);
      surface.specular_roughness = both.roughness;
      surface.specular_anisotropy = both.anisotropy;
    } else if (u < v) {
      report.warn(location,
                  "a coatedconductor that is rougher across its tangent is as rough in all directions");
      surface.specular_roughness = float(std::pow(u * v, 0.25));
    }
  } else if (below.u != below.v) {
    report.warn(location, "a coatedconductor whose roughness has a texture is as rough in all directions");
  }
  return both_sides("coatedconductor", surface);
}

double MaterialReader::index(Parameters& parameters, std::string_view name, SourceLocation location,
                             double fallback, float* abbe) {
  Parameter* eta = parameters.take(name);
  if (eta == nullptr) return fallback;
  double value = eta->numbers.size() == 1 ? eta->numbers[0] : 0.0;
  if (eta->type == "spectrum") {
    const auto glass = eta->texts.size() == 1 ? glass_named(eta->texts[0]) : std::nullopt;
    if (glass && abbe != nullptr)
      *abbe = float(glass->abbe);
    else
      context_.report.warn_counted(eta->location, "a refractive index is the same at all wavelengths");
    // From a table, the value in the middle of the visible range.
    const auto colour =
        glass ? std::nullopt
              : colour_of(*eta, ColourOf::kIndex, context_.files, context_.folder, context_.report);
    if (!glass && !colour) return fallback;
    value = glass ? glass->index : double(colour->y);
  } else if (eta->type != "float") {
    context_.report.unsupported(eta->location, "a refractive index is a float or a spectrum",
                                fmt::format("it is {}", fallback));
    return fallback;
  }
  if (value >= 1e-3 && value <= 1e3) return value;
  context_.report.error(parameters.location(name, location),
                        fmt::format("a refractive index must be in [0.001, 1000], not {}", value));
  return 1.5;
}

SurfaceMaterial MaterialReader::coated_diffuse(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  const double optical_depth = coating_depth(parameters, location);
  parameters.accept({"g", "nsamples", "twosided"});
  TexturedColour colour =
      textures_.colour(parameters, "reflectance", ColourOf::kReflectance, glm::vec3(0.5f));
  const std::int64_t depth = parameters.integer("maxdepth", 10, report);
  if (depth < 1) report.error(parameters.location("maxdepth", location), "maxdepth must be at least 1");
  // The refractive index is reported by plastic_with.
  const Parameter* eta = parameters.find("eta");
  const double ior = eta != nullptr && eta->numbers.size() == 1 ? eta->numbers[0] : 1.5;
  if (depth >= 1 && ior >= 1.0 && ior <= double(kMostIndexRatio)) {
    const Roughness rough = roughness(parameters, "", location);
    const double reflected =
        rough.smooth() || rough.u.texture != kNoTexture || rough.v.texture != kNoTexture || ior == 1.0
            ? smooth_internal_reflectance(ior, optical_depth)
            : RoughBoundary{.distribution = DISTRIBUTION_GGX,
                            .alpha = std::max(std::sqrt(double(rough.u.value) * double(rough.v.value)),
                                              double(LEAST_ALPHA)),
                            .ior = ior,
                            .optical_depth = optical_depth}
                  .internal_reflectance();
    const auto cut = [&](glm::dvec3 reflectance) {
      for (int c = 0; c < 3; ++c)
        reflectance[c] = cut_interreflection(std::clamp(reflectance[c], 0.0, 1.0), reflected, int(depth));
      return reflectance;
    };
    if (colour.texture == kNoTexture)
      colour.value = glm::vec3(cut(glm::dvec3(colour.value)));
    else if (const auto [known, is_new] = cut_.try_emplace({colour.texture, reflected, depth});
             is_new ? (known->second = textures_.of_texels(colour.texture, cut)) : known->second)
      colour.texture = *known->second;
    else
      report.warn_counted(parameters.location("reflectance", location),
                          "under a coateddiffuse whose reflectance is a texture that is no image, light "
                          "goes to and fro for ever");
  }
  return plastic_with(parameters, colour, optical_depth, location);
}

SurfaceMaterial MaterialReader::plastic_with(Parameters& parameters, const TexturedColour& colour,
                                             double optical_depth, SourceLocation location) {
  constexpr const char* name = "coateddiffuse";
  ReaderReport& report = context_.report;
  const double given = index(parameters, "eta", location, 1.5);
  const Roughness rough = roughness(parameters, "", location);
  // Without a boundary only the base remains.
  if (given == 1.0) {
    DiffuseBsdf model;
    model.reflectance = colour;
    return both_sides(name, model);
  }
  const auto eta = float(std::clamp(given, 1.0 / kMostIndexRatio, double(kMostIndexRatio)));
  if (eta != float(given))
    report.warn(
        parameters.location("eta", location),
        fmt::format("the boundary of a {} has an index up to {}, not {}", name, kMostIndexRatio, given));
  if (rough.smooth()) {
    PlasticBsdf model;
    model.optical_depth = float(optical_depth);
    model.diffuse = colour;
    model.int_ior = eta;
    model.ext_ior = 1.0f;
    model.nonlinear = true;
    return both_sides(name, model);
  }
  RoughPlasticBsdf model;
  model.optical_depth = float(optical_depth);
  model.diffuse = colour;
  model.int_ior = eta;
  model.ext_ior = 1.0f;
  model.nonlinear = true;
  model.distribution = DISTRIBUTION_GGX;
  if (rough.u != rough.v)
    report.warn(location, fmt::format("the boundary of a {} is as rough in all directions", name));
  model.alpha = rough.u;
  if (rough.u.texture == kNoTexture && rough.v.texture == kNoTexture)
    model.alpha = TexturedNumber(std::sqrt(rough.u.value * rough.v.value));
  return both_sides(name, model);
}

SurfaceMaterial MaterialReader::dielectric(Parameters& parameters, SourceLocation location, double fallback) {
  float abbe = 0.0f;
  const float eta = float(index(parameters, "eta", location, fallback, &abbe));
  const Roughness rough = roughness(parameters, "", location);
  if (rough.smooth()) {
    DielectricBsdf model;
    model.int_ior = eta;
    model.ext_ior = 1.0f;
    model.abbe = abbe;
    return surface_of("dielectric", model);
  }
  RoughDielectricBsdf model;
  model.int_ior = eta;
  model.ext_ior = 1.0f;
  model.abbe = abbe;
  model.distribution = DISTRIBUTION_GGX;
  model.alpha_u = rough.u;
  model.alpha_v = rough.v;
  return surface_of("dielectric", model);
}

SurfaceMaterial MaterialReader::thin_dielectric(Parameters& parameters, SourceLocation location) {
  ThinDielectricBsdf model;
  model.int_ior = float(index(parameters, "eta", location));
  model.ext_ior = 1.0f;
  return surface_of("thindielectric", model);
}

SurfaceMaterial MaterialReader::diffuse_transmission(Parameters& parameters, SourceLocation location) {
  DiffuseTransmitterBsdf sheet;
  sheet.reflectance = textures_.colour(parameters, "reflectance", ColourOf::kReflectance, glm::vec3(0.25f));
  sheet.transmittance =
      textures_.colour(parameters, "transmittance", ColourOf::kReflectance, glm::vec3(0.25f));
  const double scale = parameters.number("scale", 1.0, context_.report);
  if (!(scale >= 0.0 && scale < 1e30)) context_.report.error(location, "a scale must be at least 0");
  for (TexturedColour* colour : {&sheet.reflectance, &sheet.transmittance}) {
    if (colour->texture == kNoTexture)
      colour->value = glm::min(colour->value * float(scale), glm::vec3(1.0f));
    else if (scale != 1.0)
      colour->texture = textures_.scaled(colour->texture, glm::vec3(float(scale)));
  }
  return surface_of("diffusetransmission", sheet);
}

namespace {

/// What a colour has to be without a boundary, so that light that went in comes out with it: of what comes to
/// the boundary from inside, evenly, the share `internal` is reflected.
double colour_under_boundary(double colour, double internal) {
  return colour / (1 - internal + colour * internal);
}

}  // namespace

/// Where the colour differs between points, light goes in and out evenly below a boundary that reflects.
SurfaceMaterial MaterialReader::textured_subsurface(Parameters& parameters, SourceLocation location,
                                                    const TexturedColour& colour, const glm::vec3& radius,
                                                    float g) {
  ReaderReport& report = context_.report;
  report.warn_counted(location,
                      "a subsurface whose reflectance is a texture is approximated by an openpbr, whose "
                      "boundary reflects nothing back inside");
  OpenPbrBsdf surface;
  surface.subsurface_weight = TexturedNumber(1.0f);
  surface.subsurface_color = colour;
  const float most = std::max({radius.x, radius.y, radius.z});
  surface.subsurface_radius = most;
  surface.subsurface_radius_scale = most > 0.0f ? radius / most : glm::vec3(1.0f);
  surface.subsurface_anisotropy = std::clamp(g, -OpenPbrBsdf::kMostAnisotropy, OpenPbrBsdf::kMostAnisotropy);
  surface.specular_ior = float(std::max(index(parameters, "eta", location, 1.33), 1.0));
  const Roughness rough = roughness(parameters, "", location);
  const bool textured = rough.u.texture != kNoTexture || rough.v.texture != kNoTexture;
  if (textured || rough.u != rough.v)
    report.warn(location, "such a subsurface is as rough everywhere and in all directions");
  surface.specular_roughness =
      std::min(float(std::pow(double(rough.u.value) * double(rough.v.value), 0.25)), 1.0f);
  parameters.accept({"sigma_a", "sigma_s"});
  return surface_of("subsurface", surface);
}

/// Subsurface scattering is the random walk of light in a dielectric. pbrt has the coefficients in 1 / mm of
/// a name, which are reduced so that g is 0; or sigma_a and sigma_s; or those of a reflectance and a mean
/// free path; a scale multiplies the coefficients, or the path.
SurfaceMaterial MaterialReader::subsurface(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  double g = parameters.number("g", 0.0, report);
  const double scale = parameters.number("scale", 1.0, report);
  if (!(std::abs(g) < 1.0) || !(scale > 0.0 && scale < 1e30)) {
    report.error(location, "a subsurface has g in (-1, 1) and a scale above 0");
    return {};
  }
  const auto constant = [&](const char* name, ColourOf kind, const glm::vec3& fallback) {
    const TexturedColour given = textures_.colour(parameters, name, kind, fallback);
    if (given.texture == kNoTexture) return given.value;
    report.unsupported(parameters.location(name, location),
                       fmt::format("textures of the {} of a subsurface are not read", name),
                       fmt::format("it is ({}, {}, {})", fallback.x, fallback.y, fallback.z));
    return fallback;
  };
  InnerMedium inside;
  const std::string name = parameters.text("name", "", report);
  const bool by_coefficients = parameters.has("sigma_a") || parameters.has("sigma_s");
  if (name.empty() && !by_coefficients && parameters.has("reflectance")) {
    const Parameter* eta = parameters.find("eta");
    const double ior = eta != nullptr && eta->numbers.size() == 1 ? eta->numbers[0] : 1.33;
    const double internal =
        ior > 1.0 && ior <= double(kMostIndexRatio) ? smooth_internal_reflectance(ior) : 0.0;
    const glm::vec3 path = constant("mfp", ColourOf::kIndex, glm::vec3(1.0f));
    const TexturedColour given =
        textures_.colour(parameters, "reflectance", ColourOf::kReflectance, glm::vec3(0.5f));
    if (given.texture != kNoTexture)
      return textured_subsurface(parameters, location, given, float(scale) * path, float(g));
    report.warn_counted(
        location,
        "the scattering for the reflectance of a subsurface assumes that light comes to the "
        "boundary from all sides: colours of 0.5 and less come out a tenth to a quarter darker");
    const glm::vec3 reflectance = given.value;
    const HalfSpace half_space(g);
    for (int c = 0; c < 3; ++c) {
      inside.extinction[c] = float(1.0 / std::max(scale * double(path[c]), 1e-30));
      inside.albedo[c] = float(half_space.single_albedo(
          colour_under_boundary(std::clamp(double(reflectance[c]), 0.0, 1.0), internal)));
    }
  } else {
    Scattering scattering = scattering_of("Wholemilk").value();
    if (!name.empty()) {
      g = 0.0;
      if (const auto found = scattering_of(name))
        scattering = *found;
      else
        report.unsupported(parameters.location("name", location),
                           fmt::format("'{}' is no material whose scattering is known{}", name,
                                       known_names(name, scattering_names(), "Known are")),
                           "it is milk");
    } else {
      scattering.absorbed = constant("sigma_a", ColourOf::kIndex, scattering.absorbed);
      scattering.scattered = constant("sigma_s", ColourOf::kIndex, scattering.scattered);
    }
    for (int c = 0; c < 3; ++c) {
      const double sum = double(scattering.absorbed[c]) + double(scattering.scattered[c]);
      inside.extinction[c] = float(scale * sum);
      inside.albedo[c] = sum > 0.0 ? float(std::min(double(scattering.scattered[c]) / sum, 1.0)) : 0.0f;
    }
  }
  inside.g = float(g);
  parameters.accept({"mfp", "reflectance", "sigma_a", "sigma_s"});
  return filled(dielectric(parameters, location, 1.33), inside);
}

/// Of several ways to give the absorption, pbrt takes the first that is given.
SurfaceMaterial MaterialReader::hair(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  HairBsdf model;
  model.offset = HairBsdf::kFromV;
  model.int_ior = float(index(parameters, "eta", location, 1.55));
  model.ext_ior = 1.0f;
  model.longitudinal_roughness = textures_.number(parameters, "beta_m", 0.3, 0.0, 1.0);
  model.azimuthal_roughness = textures_.number(parameters, "beta_n", 0.3, 0.0, 1.0);
  model.scale_tilt = float(parameters.number("alpha", 2.0, report));
  if (!(std::abs(model.scale_tilt) <= HairBsdf::kMostTilt))
    report.error(parameters.location("alpha", location),
                 fmt::format("the scales of hair are tilted by at most {} degrees, not by {}",
                             HairBsdf::kMostTilt, model.scale_tilt));
  const char* colour = parameters.has("reflectance") ? "reflectance" : "color";
  if (parameters.has("sigma_a")) {
    model.sigma_a = textures_.colour(parameters, "sigma_a", ColourOf::kIndex, glm::vec3(0.0f));
    model.absorption = HairBsdf::Absorption::kCoefficient;
  } else if (parameters.has(colour)) {
    model.reflectance = textures_.colour(parameters, colour, ColourOf::kReflectance, glm::vec3(0.5f));
    model.absorption = HairBsdf::Absorption::kColour;
  } else {
    const bool pigments = parameters.has("eumelanin") || parameters.has("pheomelanin");
    const auto pigment = [&](const char* name, double fallback) {
      const TexturedNumber given =
          textures_.number(parameters, name, fallback, 0.0, double(HairBsdf::kMostPigment));
      if (given.texture != kNoTexture)
        report.unsupported(parameters.location(name, location), "textures of pigments are not read",
                           fmt::format("there is {} of it", fallback));
      return given.texture != kNoTexture ? float(fallback) : given.value;
    };
    model.eumelanin = pigment("eumelanin", pigments ? 0.0 : 1.3);
    model.pheomelanin = pigment("pheomelanin", 0.0);
  }
  parameters.accept({"sigma_a", "reflectance", "color", "eumelanin", "pheomelanin"});
  return surface_of("hair", model);
}

SurfaceMaterial MaterialReader::measured(Parameters& parameters, SourceLocation location) {
  ReaderReport& report = context_.report;
  MeasuredBsdf model;
  model.filename = parameters.text("filename", "", report);
  if (model.filename.empty()) {
    report.error(location, "a measured material needs a \"string filename\"");
    return {};
  }
  const std::array<std::filesystem::path, 1> folders = {context_.folder};
  const auto path = context_.files.find(model.filename, folders);
  auto brdf = path ? measured_.read(context_.files, *path) : std::unexpected(path.error());
  if (!brdf) {
    report.error(parameters.location("filename", location), brdf.error().message);
    return {};
  }
  model.filename = path->string();
  model.brdf = std::move(*brdf);
  return both_sides("measured", std::move(model));
}

/// `amount` is the weight of the second material.
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
