// Converts glTF's metallic-roughness materials to materials of a scene.
#pragma once

#include <compare>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "scenes/gltf/texture_builder.h"
#include "scenes/material_tree.h"

namespace penumbra::gltf {

/// The material of a surface, its emission, and the vertex data that it needs.
struct SurfaceOfMaterial {
  int front = kBlackBsdf, back = kBlackBsdf;
  std::optional<glm::vec3> radiance = std::nullopt;
  int radiance_texture = kNoTexture;  ///< multiplies the radiance
  bool two_sided_emission = false;
  bool unlit = false;         ///< unlit material: the radiance only makes its colour visible unchanged
  int texcoord = -1;          ///< the set of texture coordinates; -1: none
  bool has_tangents = false;  ///< whether a texture or a turn refers to tangent and bitangent
};

/// What a material is made for: whether the mesh has colours of vertices, and whether the texture coordinates
/// mirror its tangents there, so that the green of normal maps counts the other way.
struct MaterialUse {
  bool coloured = false, mirrored = false;
  friend auto operator<=>(const MaterialUse&, const MaterialUse&) = default;
};

class MaterialBuilder {
 public:
  MaterialBuilder(const Asset& asset, ReaderReport& report, TextureBuilder& textures, SceneDescription& scene)
      : asset_(asset), report_(report), textures_(textures), scene_(scene) {}

  /// The surface of material number `material`; -1 is glTF's default material.
  const SurfaceOfMaterial& surface(int material, const MaterialUse& where);

 private:
  SurfaceOfMaterial build(const tinygltf::Material& material, std::size_t index, const MaterialUse& where);
  /// The base colour of a surface and its opacity, whichever material model defines them.
  struct Base {
    glm::vec3 colour{1.0f};
    double alpha = 1.0;
    TextureUse texture{};
  };
  Base base_of(const tinygltf::Material& material, std::size_t index);
  SurfaceMaterial specular_glossiness(const tinygltf::Material& material, std::size_t index, const Base& base,
                                      bool coloured);
  SurfaceMaterial metal_rough(const tinygltf::Material& material, std::size_t index, const Base& base,
                              const MaterialUse& where);
  /// The core of a material with what its other extensions add.
  SurfaceMaterial layers(const tinygltf::Material& material, std::size_t index,
                         const MetalRoughParameters& core, const MaterialUse& where);
  void add_sheen(const tinygltf::Material& material, std::size_t index, OpenPbrBsdf& surface);
  void add_film(const tinygltf::Material& material, std::size_t index, OpenPbrBsdf& surface);
  /// Returns the turn of the tangents by which it goes.
  SurfaceTurn add_anisotropy(const tinygltf::Material& material, std::size_t index, OpenPbrBsdf& surface,
                             bool mirrored);
  void add_diffuse_transmission(const tinygltf::Material& material, std::size_t index, OpenPbrBsdf& surface);
  SurfaceMaterial lit_part(const tinygltf::Material& material, std::size_t index, const MaterialUse& where);
  /// Bends the normals of the surface and of its coat by their textures.
  void add_normals(const tinygltf::Material& material, std::size_t index, const MaterialUse& where,
                   SurfaceMaterial& surface);
  /// How much of the surface there is (alphaMode). Nothing: all of it.
  std::optional<TexturedNumber> coverage(const tinygltf::Material& material, const Base& base);
  void add_emission(const tinygltf::Material& material, std::size_t index, const Base& base, bool coloured,
                    const std::optional<TexturedNumber>& coverage, SurfaceOfMaterial& result);
  TexturedColour base_colour(const Base& base, bool coloured);
  TexturedNumber number(double factor, const TextureUse& texture, BitmapChannels channel);
  TextureUse use(const tinygltf::TextureInfo& info, std::size_t material, const char* name);
  TextureUse extension_use(const tinygltf::Value& extension, const char* texture, std::size_t material);
  SourceLocation place(std::size_t material, const char* name) const {
    return asset_.place({"materials", material, std::string_view(name)});
  }

  const Asset& asset_;
  ReaderReport& report_;
  TextureBuilder& textures_;
  SceneDescription& scene_;
  MaterialInstaller installer_;
  std::map<std::pair<int, MaterialUse>, SurfaceOfMaterial> surfaces_;
  int texcoord_ = -1;  ///< of the material that is being built
};

}  // namespace penumbra::gltf
