#include "scenes/gltf/material_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace penumbra::gltf {

namespace {

const tinygltf::Value* extension_of(const tinygltf::Material& material, const char* name) {
  const auto found = material.extensions.find(name);
  return found == material.extensions.end() ? nullptr : &found->second;
}

double number_of(const tinygltf::Value* extension, const char* name, double fallback) {
  if (extension == nullptr || !extension->Has(name)) return fallback;
  const tinygltf::Value& value = extension->Get(name);
  return value.IsNumber() && std::isfinite(value.GetNumberAsDouble()) ? value.GetNumberAsDouble() : fallback;
}

float unit(double value) { return std::isfinite(value) ? float(std::clamp(value, 0.0, 1.0)) : 0.0f; }

glm::vec3 colour_of(const std::vector<double>& numbers) {
  glm::vec3 colour(1.0f);
  for (int c = 0; c < 3; ++c)
    if (std::size_t(c) < numbers.size()) colour[c] = unit(numbers[std::size_t(c)]);
  return colour;
}

double alpha_of(const std::vector<double>& factor) {
  return factor.size() > 3 && std::isfinite(factor[3]) ? std::clamp(factor[3], 0.0, 1.0) : 1.0;
}

std::vector<double> numbers_of(const tinygltf::Value& extension, const char* name,
                               std::vector<double> fallback) {
  if (!extension.Has(name) || !extension.Get(name).IsArray()) return fallback;
  const tinygltf::Value& array = extension.Get(name);
  std::vector<double> numbers;
  for (std::size_t i = 0; i < array.ArrayLen(); ++i)
    numbers.push_back(array.Get(int(i)).IsNumber() ? array.Get(int(i)).GetNumberAsDouble() : 0.0);
  return numbers;
}

constexpr double kMostSpecularColour = 1e6;
constexpr const char* kSpecularGlossiness = "KHR_materials_pbrSpecularGlossiness";

std::string name_of(const tinygltf::Material& material, std::size_t index) {
  return material.name.empty() ? fmt::format("material {}", index) : material.name;
}

}  // namespace

const SurfaceOfMaterial& MaterialBuilder::surface(int material, const MaterialUse& where) {
  const auto [entry, is_new] = surfaces_.try_emplace({material, where});
  if (!is_new) return entry->second;
  const auto& materials = asset_.model.materials;
  if (material < 0) {
    entry->second = build(tinygltf::Material(), materials.size(), where);
  } else {
    entry->second = build(materials[std::size_t(material)], std::size_t(material), where);
  }
  return entry->second;
}

TextureUse MaterialBuilder::use(const tinygltf::TextureInfo& info, std::size_t material, const char* name) {
  TextureUse use = texture_use(info.index, info.texCoord, info.extensions, place(material, name));
  if (!use.there()) return use;
  if (texcoord_ >= 0 && use.texcoord != texcoord_)
    report_.warn_counted(
        use.location,
        fmt::format("textures of '{}' use texture coordinates {} and {}; those of the first stand "
                    "in for the others",
                    name_of(asset_.model.materials[material], material), texcoord_, use.texcoord));
  else
    texcoord_ = use.texcoord;
  return use;
}

TextureUse MaterialBuilder::extension_use(const tinygltf::Value& extension, const char* texture,
                                          std::size_t material) {
  if (!extension.Has(texture)) return {};
  const tinygltf::Value& value = extension.Get(texture);
  tinygltf::TextureInfo info;
  if (value.Has("index")) info.index = value.Get("index").GetNumberAsInt();
  if (value.Has("texCoord")) info.texCoord = value.Get("texCoord").GetNumberAsInt();
  if (value.Has("extensions") && value.Get("extensions").Has("KHR_texture_transform"))
    info.extensions["KHR_texture_transform"] = value.Get("extensions").Get("KHR_texture_transform");
  return use(info, material, "extensions");
}

MaterialBuilder::Base MaterialBuilder::base_of(const tinygltf::Material& material, std::size_t index) {
  if (const tinygltf::Value* other = extension_of(material, kSpecularGlossiness)) {
    const auto factor = numbers_of(*other, "diffuseFactor", {1.0, 1.0, 1.0, 1.0});
    return {colour_of(factor), alpha_of(factor), extension_use(*other, "diffuseTexture", index)};
  }
  const auto& pbr = material.pbrMetallicRoughness;
  return {colour_of(pbr.baseColorFactor), alpha_of(pbr.baseColorFactor),
          use(pbr.baseColorTexture, index, "pbrMetallicRoughness")};
}

TexturedColour MaterialBuilder::base_colour(const Base& base, bool coloured) {
  TexturedColour colour(base.colour);
  if (base.texture.there())
    if (const auto index = textures_.colours(base.texture))
      colour.texture = textures_.scaled(*index, base.colour);
  if (coloured) {
    const int vertices = textures_.vertex_colours(colour.texture);
    colour.texture = colour.texture == kNoTexture ? textures_.scaled(vertices, base.colour) : vertices;
  }
  return colour;
}

SurfaceMaterial MaterialBuilder::specular_glossiness(const tinygltf::Material& material, std::size_t index,
                                                     const Base& base, bool coloured) {
  const tinygltf::Value& extension = *extension_of(material, kSpecularGlossiness);
  const TextureUse texture = extension_use(extension, "specularGlossinessTexture", index);
  MetalRoughParameters surface;
  surface.base_color = base_colour(base, coloured);
  surface.ior = 0.0f;  // reflects the specular colour along the normal
  surface.specular_color =
      TexturedColour(colour_of(numbers_of(extension, "specularFactor", {1.0, 1.0, 1.0})));
  const double glossiness = double(unit(number_of(&extension, "glossinessFactor", 1.0)));
  surface.roughness = TexturedNumber(float(1.0 - glossiness));
  if (texture.there()) {
    if (const auto colours = textures_.colours(texture))
      surface.specular_color.texture =
          textures_.scaled(*colours, surface.specular_color.value * MetalRoughParameters::kWithoutIndex);
    if (const auto rough = textures_.roughness_of(texture, glossiness)) {
      surface.roughness = TexturedNumber(1.0f);
      surface.roughness.texture = *rough;
    }
  }
  SurfaceMaterial both = surface_of(name_of(material, index), surface.as_openpbr());
  both.back = both.front;
  return both;
}

TexturedNumber MaterialBuilder::number(double factor, const TextureUse& texture, BitmapChannels channel) {
  TexturedNumber number(unit(factor));
  if (!texture.there() || number.value == 0.0f) return number;
  if (const auto index = textures_.channel(texture, channel))
    number.texture = textures_.scaled(*index, glm::vec3(number.value));
  return number;
}

SurfaceMaterial MaterialBuilder::metal_rough(const tinygltf::Material& material, std::size_t index,
                                             const Base& base, const MaterialUse& where) {
  const auto& pbr = material.pbrMetallicRoughness;
  const std::string name = name_of(material, index);
  const TextureUse rough = use(pbr.metallicRoughnessTexture, index, "pbrMetallicRoughness");
  MetalRoughParameters surface;
  surface.base_color = base_colour(base, where.coloured);
  surface.roughness = number(pbr.roughnessFactor, rough, BitmapChannels::kGreen);
  surface.metallic = number(pbr.metallicFactor, rough, BitmapChannels::kBlue);
  const double ior = number_of(extension_of(material, "KHR_materials_ior"), "ior", 1.5);
  if (ior >= 1.0 || ior == 0.0)
    surface.ior = float(ior);
  else
    report_.warn(place(index, "extensions"),
                 fmt::format("'{}': the refractive index {} is read as 1.5", name, ior));
  if (const auto* specular = extension_of(material, "KHR_materials_specular")) {
    surface.specular = number(number_of(specular, "specularFactor", 1.0),
                              extension_use(*specular, "specularTexture", index), BitmapChannels::kAlpha);
    const auto factor = numbers_of(*specular, "specularColorFactor", {1.0, 1.0, 1.0});
    for (std::size_t c = 0; c < 3 && c < factor.size(); ++c)
      surface.specular_color.value[int(c)] = float(std::clamp(factor[c], 0.0, kMostSpecularColour));
    const TextureUse colours = extension_use(*specular, "specularColorTexture", index);
    if (colours.there())
      if (const auto texture = textures_.colours(colours))
        surface.specular_color.texture =
            textures_.scaled(*texture, surface.specular_color.value *
                                           (ior == 0.0 ? MetalRoughParameters::kWithoutIndex : 1.0f));
  }
  if (const auto* coat = extension_of(material, "KHR_materials_clearcoat")) {
    surface.clearcoat = number(number_of(coat, "clearcoatFactor", 0.0),
                               extension_use(*coat, "clearcoatTexture", index), BitmapChannels::kRed);
    surface.clearcoat_roughness =
        number(number_of(coat, "clearcoatRoughnessFactor", 0.0),
               extension_use(*coat, "clearcoatRoughnessTexture", index), BitmapChannels::kGreen);
  }
  return layers(material, index, surface, where);
}

SurfaceMaterial MaterialBuilder::layers(const tinygltf::Material& material, std::size_t index,
                                        const MetalRoughParameters& core, const MaterialUse& where) {
  TexturedNumber transmitted;
  if (const auto* transmission = extension_of(material, "KHR_materials_transmission"))
    transmitted = number(number_of(transmission, "transmissionFactor", 0.0),
                         extension_use(*transmission, "transmissionTexture", index), BitmapChannels::kRed);
  const bool transmits = transmitted.value > 0.0f;
  OpenPbrBsdf surface = core.as_openpbr(transmits);
  if (transmits) {
    surface.transmission_weight = transmitted;
    surface.transmission_color = core.base_color;
    const auto* volume = extension_of(material, "KHR_materials_volume");
    // Without a volume, glTF's transmitting surfaces are thin.
    surface.thin_walled = !(number_of(volume, "thicknessFactor", 0.0) > 0.0);
    if (const auto* dispersion = extension_of(material, "KHR_materials_dispersion")) {
      constexpr double kMost = 20.0 / kLeastAbbe;
      const double amount = std::clamp(number_of(dispersion, "dispersion", 0.0), 0.0, kMost);
      surface.dispersion_scale = amount > 0.0 ? 1.0f : 0.0f;
      surface.dispersion_abbe = float(20.0 / std::max(amount, 1.0 / kMost));  // by the extension's definition
    }
    const double distance = number_of(volume, "attenuationDistance", 0.0);
    if (!surface.thin_walled && distance > 0.0) {
      const glm::vec3 colour = colour_of(numbers_of(*volume, "attenuationColor", {1.0, 1.0, 1.0}));
      if (colour != glm::vec3(1.0f)) {
        surface.attenuation = colour;
        surface.transmission_depth = float(std::clamp(distance, 1e-30, 1e30));
      }
    }
  }
  add_sheen(material, index, surface);
  add_film(material, index, surface);
  add_diffuse_transmission(material, index, surface);
  const SurfaceTurn turn = add_anisotropy(material, index, surface, where.mirrored);
  SurfaceMaterial whole = surface_of(name_of(material, index), surface);
  if (!transmits)
    whole.back = whole.front;  // both sides are the same, as in a rasteriser's two-sided materials
  return turn.turns() ? turned(whole, turn) : whole;
}

void MaterialBuilder::add_sheen(const tinygltf::Material& material, std::size_t index, OpenPbrBsdf& surface) {
  const auto* sheen = extension_of(material, "KHR_materials_sheen");
  if (sheen == nullptr) return;
  const glm::vec3 colour = colour_of(numbers_of(*sheen, "sheenColorFactor", {0.0, 0.0, 0.0}));
  const float most = std::max({colour.x, colour.y, colour.z});
  if (most == 0.0f) return;
  if (surface.coated())
    report_.warn_counted(place(index, "extensions"),
                         "KHR_materials_sheen: it is above the clear coat, not below it");
  surface.fuzz_weight = TexturedNumber(most);
  surface.fuzz_color = TexturedColour(colour / most);
  const TextureUse colours = extension_use(*sheen, "sheenColorTexture", index);
  if (colours.there())
    if (const auto texture = textures_.colours(colours))
      surface.fuzz_color.texture = textures_.scaled(*texture, colour / most);
  surface.fuzz_roughness =
      number(number_of(sheen, "sheenRoughnessFactor", 0.0),
             extension_use(*sheen, "sheenRoughnessTexture", index), BitmapChannels::kAlpha);
}

void MaterialBuilder::add_film(const tinygltf::Material& material, std::size_t index, OpenPbrBsdf& surface) {
  const auto* film = extension_of(material, "KHR_materials_iridescence");
  if (film == nullptr) return;
  surface.film_weight = number(number_of(film, "iridescenceFactor", 0.0),
                               extension_use(*film, "iridescenceTexture", index), BitmapChannels::kRed);
  if (!surface.filmed()) return;
  const auto micrometres = [&](const char* name, double fallback) {
    constexpr double kMost = 1e3 * double(OpenPbrBsdf::kMostFilm);
    return float(1e-3 * std::clamp(number_of(film, name, fallback), 0.0, kMost));
  };
  surface.film_least = micrometres("iridescenceThicknessMinimum", 100.0);
  surface.film_most = micrometres("iridescenceThicknessMaximum", 400.0);
  const TexturedNumber between =
      number(1.0, extension_use(*film, "iridescenceThicknessTexture", index), BitmapChannels::kGreen);
  surface.film_thickness = TexturedNumber(surface.film_most);
  surface.film_thickness.texture = between.texture;
  surface.film_ior = float(std::max(number_of(film, "iridescenceIor", 1.3), 1.0));
  if (surface.coated())
    report_.warn_counted(place(index, "extensions"),
                         "KHR_materials_iridescence: below a clear coat the film reflects less");
}

SurfaceTurn MaterialBuilder::add_anisotropy(const tinygltf::Material& material, std::size_t index,
                                            OpenPbrBsdf& surface, bool mirrored) {
  const auto* anisotropy = extension_of(material, "KHR_materials_anisotropy");
  if (anisotropy == nullptr) return {};
  const TextureUse texture = extension_use(*anisotropy, "anisotropyTexture", index);
  surface.specular_anisotropy =
      number(number_of(anisotropy, "anisotropyStrength", 0.0), texture, BitmapChannels::kBlue);
  if (!surface.anisotropic()) return {};
  SurfaceTurn turn{.angle = float(std::remainder(number_of(anisotropy, "anisotropyRotation", 0.0),
                                                 2.0 * std::numbers::pi)),
                   .mirrored = mirrored};
  if (texture.there()) turn.texture = textures_.vectors(texture).value_or(kNoTexture);
  return turn;
}

void MaterialBuilder::add_diffuse_transmission(const tinygltf::Material& material, std::size_t index,
                                               OpenPbrBsdf& surface) {
  const auto* extension = extension_of(material, "KHR_materials_diffuse_transmission");
  if (extension == nullptr) return;
  const TexturedNumber weight =
      number(number_of(extension, "diffuseTransmissionFactor", 0.0),
             extension_use(*extension, "diffuseTransmissionTexture", index), BitmapChannels::kAlpha);
  if (weight == TexturedNumber(0.0f)) return;
  if (surface.transmits() && !surface.thin_walled)
    return report_.warn_counted(place(index, "extensions"),
                                "KHR_materials_diffuse_transmission: of a volume that also transmits without "
                                "scattering it is ignored");
  // A sheet that scatters this share of its diffuse light to the other side.
  surface.thin_walled = true;
  surface.subsurface_anisotropy = 1.0f;
  surface.subsurface_weight = weight;
  surface.subsurface_color =
      TexturedColour(colour_of(numbers_of(*extension, "diffuseTransmissionColorFactor", {1.0, 1.0, 1.0})));
  const TextureUse colours = extension_use(*extension, "diffuseTransmissionColorTexture", index);
  if (colours.there())
    if (const auto texture = textures_.colours(colours))
      surface.subsurface_color.texture = textures_.scaled(*texture, surface.subsurface_color.value);
}

SurfaceMaterial MaterialBuilder::lit_part(const tinygltf::Material& material, std::size_t index,
                                          const MaterialUse& where) {
  if (extension_of(material, "KHR_materials_unlit") != nullptr) return {};  // it only emits
  const Base base = base_of(material, index);
  return extension_of(material, kSpecularGlossiness) != nullptr
             ? specular_glossiness(material, index, base, where.coloured)
             : metal_rough(material, index, base, where);
}

std::optional<TexturedNumber> MaterialBuilder::coverage(const tinygltf::Material& material,
                                                        const Base& base) {
  const bool cut = material.alphaMode == "MASK";
  if (!cut && material.alphaMode != "BLEND") return std::nullopt;
  const double factor = base.alpha;
  TexturedNumber opacity(float(cut ? (factor >= material.alphaCutoff ? 1.0 : 0.0) : factor));
  if (base.texture.there()) {
    const auto texture =
        cut ? textures_.cut_alpha(base.texture, factor, material.alphaCutoff) : textures_.alpha(base.texture);
    if (texture) opacity.texture = cut ? *texture : textures_.scaled(*texture, glm::vec3(float(factor)));
  }
  if (opacity.texture == kNoTexture && opacity.value == 1.0f) return std::nullopt;
  return opacity;
}

void MaterialBuilder::add_emission(const tinygltf::Material& material, std::size_t index, const Base& base,
                                   bool coloured, const std::optional<TexturedNumber>& coverage,
                                   SurfaceOfMaterial& result) {
  const tinygltf::Value* strength = extension_of(material, "KHR_materials_emissive_strength");
  glm::vec3 emitted(0.0f);
  for (std::size_t c = 0; c < 3 && c < material.emissiveFactor.size(); ++c)
    emitted[int(c)] = unit(material.emissiveFactor[c]);
  emitted *= float(std::clamp(number_of(strength, "emissiveStrength", 1.0), 0.0, 1e30));
  if (extension_of(material, "KHR_materials_unlit") != nullptr) {
    report_.warn_counted(
        place(index, "extensions"),
        "KHR_materials_unlit: such surfaces are area lights of their base colour, and light others");
    result.radiance = base.colour;
    result.radiance_texture = base_colour({glm::vec3(1.0f), base.alpha, base.texture}, coloured).texture;
    result.two_sided_emission = result.unlit = true;
  } else if (emitted != glm::vec3(0.0f)) {
    const TextureUse glow = use(material.emissiveTexture, index, "emissiveTexture");
    if (glow.there()) result.radiance_texture = textures_.colours(glow).value_or(kNoTexture);
    result.radiance = emitted;
    result.two_sided_emission = material.doubleSided;
  }
  if (!result.radiance || !coverage) return;
  // What is not there does not shine.
  if (coverage->texture != kNoTexture)
    result.radiance_texture = textures_.product(result.radiance_texture, coverage->texture);
  else if (coverage->value > 0.0f)
    result.radiance = *result.radiance * coverage->value;
  else
    result.radiance.reset();
}

void MaterialBuilder::add_normals(const tinygltf::Material& material, std::size_t index,
                                  const MaterialUse& where, SurfaceMaterial& surface) {
  if (surface.front == nullptr) return;
  const auto* layers = std::get_if<OpenPbrBsdf>(&surface.front->bsdf.model);
  const bool coated = layers != nullptr && layers->coated();
  const auto bend = [&](const std::optional<int>& normals, BentLayers which) {
    // Its bumps do not shade each other: glTF's BSDF has the bent normal instead of the other.
    if (normals)
      surface = bent(surface, {.kind = BendKind::kNormalMap, .texture = *normals, .shadows = false}, which);
  };
  const auto& bump = material.normalTexture;
  if (bump.index >= 0) {
    tinygltf::TextureInfo info;
    info.index = bump.index;
    info.texCoord = bump.texCoord;
    info.extensions = bump.extensions;
    bend(textures_.normals(use(info, index, "normalTexture"), bump.scale, where.mirrored),
         coated ? BentLayers::kBase : BentLayers::kAll);
  }
  const auto* coat = extension_of(material, "KHR_materials_clearcoat");
  if (!coated || coat == nullptr) return;
  const TextureUse of_coat = extension_use(*coat, "clearcoatNormalTexture", index);
  if (of_coat.there())
    bend(textures_.normals(of_coat, number_of(&coat->Get("clearcoatNormalTexture"), "scale", 1.0),
                           where.mirrored),
         BentLayers::kCoat);
}

SurfaceOfMaterial MaterialBuilder::build(const tinygltf::Material& material, std::size_t index,
                                         const MaterialUse& where) {
  texcoord_ = -1;
  SurfaceOfMaterial result;
  SurfaceMaterial surface = lit_part(material, index, where);
  add_normals(material, index, where, surface);
  result.has_tangents = is_bent(surface.front) || is_turned(surface.front);
  if (material.occlusionTexture.index >= 0)
    report_.warn_counted(place(index, "occlusionTexture"),
                         "textures of occlusion are ignored: what they darken is computed");
  const Base base = base_of(material, index);
  const auto opacity = coverage(material, base);
  if (opacity) {
    MaskBsdf mask;
    mask.opacity = *opacity;
    surface = masked(name_of(material, index), mask, surface);
  }
  std::tie(result.front, result.back) = installer_.add(surface, scene_);
  add_emission(material, index, base, where.coloured, opacity, result);
  result.texcoord = texcoord_;
  return result;
}

}  // namespace penumbra::gltf
