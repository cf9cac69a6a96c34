// Reads Wavefront MTL files, the materials of OBJ files.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>

#include "scenes/diagnostic.h"

namespace penumbra::tinyrender {

/// An image that multiplies a value. Its coordinates are u and v of the surface times `scale` plus `offset`;
/// v counts from the bottom.
struct MtlMap {
  std::string name;
  SourceLocation location = {};  ///< of the name
  glm::dvec2 scale{1.0}, offset{0.0};
  bool clamp = false;
};

/// The statements of one material. Colours are linear Rec. 709 and at least 0, as in the file.
struct MtlMaterial {
  SourceLocation location = {};                       ///< of its name
  std::optional<glm::vec3> diffuse = std::nullopt;    ///< Kd
  std::optional<glm::vec3> specular = std::nullopt;   ///< Ks
  std::optional<glm::vec3> emission = std::nullopt;   ///< Ke
  std::optional<float> exponent = std::nullopt;       ///< Ns
  std::optional<MtlMap> diffuse_map = std::nullopt;   ///< map_Kd
  std::optional<MtlMap> specular_map = std::nullopt;  ///< map_Ks
  std::optional<MtlMap> exponent_map = std::nullopt;  ///< map_Ns
  std::int64_t illum = 0;                             ///< the reflection model's number
};

using MtlMaterials = std::map<std::string, MtlMaterial, std::less<>>;

/// Adds the materials of `file` to `materials`. If two have the same name, the first is used, as in
/// TinyRender, with a warning. Unknown statements and unsupported textures are ignored with a warning.
/// Errors: malformed colours, exponents, textures and numbers of reflection models; values before the first
/// name.
void read_mtl(const SourceFile& file, MtlMaterials& materials, Diagnostics& diagnostics);

}  // namespace penumbra::tinyrender
