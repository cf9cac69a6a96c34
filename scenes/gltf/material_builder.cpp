#include "scenes/gltf/material_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/gltf/specular_glossiness.h"

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

constexpr const char* kSpecularGlossiness = "KHR_materials_pbrSpecularGlossiness";

/// The refractive index whose reflectance at normal incidence is `factor` times that of `ior`.
float index_with(double ior, double factor) {
  const double root = std::sqrt(std::clamp(factor, 0.0, 1.0)) * std::abs((ior - 1) / (ior + 1));
  return float((1 + root) / (1 - root));
}

std::string name_of(const tinygltf::Material& material, std::size_t index) {
  return material.name.empty() ? fmt::format("material {}", index) : material.name;
}

}  // namespace

const SurfaceOfMaterial& MaterialBuilder::surface(int material, bool coloured) {
  const auto [entry, is_new] = surfaces_.try_emplace({material, coloured});
  if (!is_new) return entry->second;
  const auto& materials = asset_.model.materials;
  if (material < 0) {
    entry->second = build(tinygltf::Material(), materials.size(), coloured);
  } else {
    entry->second = build(materials[std::size_t(material)], std::size_t(material), coloured);
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
  if (base.texture.there()) {
    if (coloured)
      report_.warn_counted(base.texture.location,
                           "colours of vertices are left out where there is a texture of the base colour");
    if (const auto index = textures_.colours(base.texture))
      colour.texture = textures_.scaled(*index, base.colour);
  } else if (coloured) {
    scene_.textures.push_back({"COLOR_0", MeshAttributeTexture{}});
    colour.texture = textures_.scaled(int(scene_.textures.size()) - 1, base.colour);
  }
  return colour;
}

SurfaceMaterial MaterialBuilder::specular_glossiness(const tinygltf::Material& material, std::size_t index,
                                                     const Base& base, bool coloured) {
  const tinygltf::Value& extension = *extension_of(material, kSpecularGlossiness);
  const glm::dvec3 diffuse(base.colour),
      specular(colour_of(numbers_of(extension, "specularFactor", {1.0, 1.0, 1.0})));
  const double glossiness = double(unit(number_of(&extension, "glossinessFactor", 1.0)));
  const TextureUse gloss = extension_use(extension, "specularGlossinessTexture", index);
  const MetalRoughness plain = metal_roughness_of(diffuse, specular, glossiness);
  PrincipledBsdf solid;
  solid.eta = 1.5f;
  solid.roughness = TexturedNumber(float(plain.roughness));
  solid.metallic = TexturedNumber(float(plain.metallic));
  if (base.texture.there() || gloss.there()) {
    if (coloured)
      report_.warn_counted(place(index, "extensions"),
                           "colours of vertices are left out where there is a texture of the base colour");
    if (const auto maps = textures_.specular_glossiness(base.texture, gloss, diffuse, specular, glossiness)) {
      solid.base_color.texture = maps->base_colour;
      solid.metallic = TexturedNumber(1.0f);
      solid.metallic.texture = maps->metallic;
      solid.roughness = TexturedNumber(1.0f);
      solid.roughness.texture = maps->roughness;
    }
  } else {
    solid.base_color = base_colour({glm::vec3(plain.base_colour), base.alpha}, coloured);
  }
  SurfaceMaterial surface = surface_of(name_of(material, index), solid);
  if (surface.back == nullptr) surface.back = surface.front;
  return surface;
}

TexturedNumber MaterialBuilder::number(double factor, const TextureUse& texture, BitmapChannels channel) {
  TexturedNumber number(unit(factor));
  if (!texture.there() || number.value == 0.0f) return number;
  if (const auto index = textures_.channel(texture, channel))
    number.texture = textures_.scaled(*index, glm::vec3(number.value));
  return number;
}

SurfaceMaterial MaterialBuilder::opaque_part(const tinygltf::Material& material, std::size_t index,
                                             bool coloured) {
  const auto& pbr = material.pbrMetallicRoughness;
  const std::string name = name_of(material, index);
  const Base base = base_of(material, index);
  if (extension_of(material, "KHR_materials_unlit") != nullptr) return {};  // it only emits, see build
  if (extension_of(material, kSpecularGlossiness) != nullptr)
    return specular_glossiness(material, index, base, coloured);
  const TextureUse rough = use(pbr.metallicRoughnessTexture, index, "pbrMetallicRoughness");
  const tinygltf::Value* ior = extension_of(material, "KHR_materials_ior");
  const tinygltf::Value* specular = extension_of(material, "KHR_materials_specular");
  const tinygltf::Value* coat = extension_of(material, "KHR_materials_clearcoat");
  const tinygltf::Value* transmission = extension_of(material, "KHR_materials_transmission");
  double index_of_refraction = number_of(ior, "ior", 1.5);
  if (!(index_of_refraction >= 1.0)) {
    report_.warn(place(index, "extensions"),
                 fmt::format("'{}': the refractive index {} is read as 1.5", name, index_of_refraction));
    index_of_refraction = 1.5;
  }
  const float eta = index_with(index_of_refraction, number_of(specular, "specularFactor", 1.0));
  if (specular != nullptr)
    report_.warn_counted(
        place(index, "extensions"),
        "KHR_materials_specular: its factor becomes a refractive index with as much reflection along "
        "the normal; its colour and textures are ignored");
  const TexturedColour colour = base_colour(base, coloured);
  const TexturedNumber roughness = number(pbr.roughnessFactor, rough, BitmapChannels::kGreen);
  const TexturedNumber metallic = number(pbr.metallicFactor, rough, BitmapChannels::kBlue);
  TexturedNumber transmitted;
  if (transmission != nullptr)
    transmitted = number(number_of(transmission, "transmissionFactor", 0.0),
                         extension_use(*transmission, "transmissionTexture", index), BitmapChannels::kRed);
  const double thickness = number_of(extension_of(material, "KHR_materials_volume"), "thicknessFactor", 0.0);
  if (transmitted.value > 0.0f && !(thickness > 0.0)) {
    // Without a volume, glTF's transmitting surfaces are thin.
    PrincipledThinBsdf thin;
    thin.base_color = colour;
    thin.roughness = roughness;
    thin.spec_trans = transmitted;
    thin.eta = TexturedNumber(eta);
    if (metallic.value > 0.0f)
      report_.warn_counted(place(index, "pbrMetallicRoughness"),
                           "metalness is ignored where KHR_materials_transmission makes a thin pane");
    return surface_of(name, thin);
  }
  PrincipledBsdf solid;
  solid.base_color = colour;
  solid.roughness = roughness;
  solid.metallic = metallic;
  solid.spec_trans = transmitted;
  solid.eta = solid.transmits() ? std::max(eta, 1.001f) : eta;
  if (solid.transmits())
    report_.warn_counted(place(index, "extensions"), "KHR_materials_volume: what it absorbs is ignored");
  if (coat != nullptr) {
    report_.warn_counted(place(index, "extensions"),
                         "KHR_materials_clearcoat is approximated by Disney's, which is a quarter as strong");
    solid.clearcoat = TexturedNumber(unit(number_of(coat, "clearcoatFactor", 0.0)));
    const double alpha = std::pow(number_of(coat, "clearcoatRoughnessFactor", 0.0), 2.0);
    solid.clearcoat_gloss = TexturedNumber(unit((0.1 - alpha) / 0.099));
  }
  SurfaceMaterial surface = surface_of(name, solid);
  if (surface.back == nullptr)
    surface.back = surface.front;  // both sides are the same, as in a rasteriser's two-sided materials
  return surface;
}

SurfaceMaterial MaterialBuilder::with_alpha(const tinygltf::Material& material, std::size_t index,
                                            SurfaceMaterial inside) {
  const bool cut = material.alphaMode == "MASK";
  if (!cut && material.alphaMode != "BLEND") return inside;
  const std::string name = name_of(material, index);
  const auto& [colour, factor, base] = base_of(material, index);
  MaskBsdf mask;
  mask.opacity = TexturedNumber(float(cut ? (factor >= material.alphaCutoff ? 1.0 : 0.0) : factor));
  if (base.there()) {
    const auto texture =
        cut ? textures_.cut_alpha(base, factor, material.alphaCutoff) : textures_.alpha(base);
    if (texture) mask.opacity.texture = cut ? *texture : textures_.scaled(*texture, glm::vec3(float(factor)));
  }
  if (mask.opacity.texture == kNoTexture && mask.opacity.value == 1.0f) return inside;
  return masked(name, mask, inside);
}

SurfaceOfMaterial MaterialBuilder::build(const tinygltf::Material& material, std::size_t index,
                                         bool coloured) {
  texcoord_ = -1;
  SurfaceOfMaterial result;
  SurfaceMaterial surface = opaque_part(material, index, coloured);
  const auto& bump = material.normalTexture;
  if (bump.index >= 0 && surface.front != nullptr) {
    tinygltf::TextureInfo info;
    info.index = bump.index;
    info.texCoord = bump.texCoord;
    info.extensions = bump.extensions;
    if (const auto normals = textures_.normals(use(info, index, "normalTexture"), bump.scale)) {
      surface = bent(surface, {BendKind::kNormalMap, *normals});
      result.has_normal_map = true;
    }
  }
  if (material.occlusionTexture.index >= 0)
    report_.warn_counted(place(index, "occlusionTexture"),
                         "textures of occlusion are ignored: what they darken is computed");
  surface = with_alpha(material, index, std::move(surface));
  std::tie(result.front, result.back) = installer_.add(surface, scene_);

  const tinygltf::Value* strength = extension_of(material, "KHR_materials_emissive_strength");
  glm::vec3 emitted(0.0f);
  for (std::size_t c = 0; c < 3 && c < material.emissiveFactor.size(); ++c)
    emitted[int(c)] = unit(material.emissiveFactor[c]);
  emitted *= float(std::clamp(number_of(strength, "emissiveStrength", 1.0), 0.0, 1e30));
  if (extension_of(material, "KHR_materials_unlit") != nullptr) {
    report_.warn_counted(
        place(index, "extensions"),
        "KHR_materials_unlit: such surfaces are area lights of their base colour, and light others");
    const Base base = base_of(material, index);
    result.radiance = base.colour;
    result.radiance_texture = base_colour({glm::vec3(1.0f), base.alpha, base.texture}, coloured).texture;
    result.two_sided_emission = result.unlit = true;
  } else if (emitted != glm::vec3(0.0f)) {
    const TextureUse glow = use(material.emissiveTexture, index, "emissiveTexture");
    if (glow.there()) result.radiance_texture = textures_.colours(glow).value_or(kNoTexture);
    result.radiance = emitted;
    result.two_sided_emission = material.doubleSided;
  }
  result.texcoord = texcoord_;
  return result;
}

}  // namespace penumbra::gltf
