// Materials of glTF, physically based by metalness and roughness, as materials of a scene.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "scenes/gltf/texture_builder.h"
#include "scenes/material_tree.h"

namespace penumbra::gltf {

/// What a surface of a material is made of, and what it needs.
struct SurfaceOfMaterial {
  int front = kBlackBsdf, back = kBlackBsdf;
  std::optional<glm::vec3> radiance = std::nullopt;
  int radiance_texture = kNoTexture;  ///< by which it is multiplied
  bool two_sided_emission = false;
  bool unlit = false;  ///< it shines only because its colour is to be seen as it is
  int texcoord = -1;   ///< the set of texture coordinates; none: -1
  bool has_normal_map = false;
};

class MaterialBuilder {
 public:
  MaterialBuilder(const Asset& asset, ReaderReport& report, TextureBuilder& textures, SceneDescription& scene)
      : asset_(asset), report_(report), textures_(textures), scene_(scene) {}

  /// Of a material's index, -1: glTF's default; `coloured`: the mesh has colours of vertices.
  const SurfaceOfMaterial& surface(int material, bool coloured);

 private:
  SurfaceOfMaterial build(const tinygltf::Material& material, std::size_t index, bool coloured);
  /// The colour of the surface, whichever model says it, with its opacity.
  struct Base {
    glm::vec3 colour{1.0f};
    double alpha = 1.0;
    TextureUse texture{};
  };
  Base base_of(const tinygltf::Material& material, std::size_t index);
  SurfaceMaterial specular_glossiness(const tinygltf::Material& material, std::size_t index, const Base& base,
                                      bool coloured);
  SurfaceMaterial opaque_part(const tinygltf::Material& material, std::size_t index, bool coloured);
  SurfaceMaterial with_alpha(const tinygltf::Material& material, std::size_t index, SurfaceMaterial inside);
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
  std::map<std::pair<int, bool>, SurfaceOfMaterial> surfaces_;
  int texcoord_ = -1;  ///< of the one that is being built
};

}  // namespace penumbra::gltf
