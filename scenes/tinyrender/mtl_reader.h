// Wavefront MTL files: the materials that OBJ files name.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>

#include "scenes/diagnostic.h"

namespace penumbra::tinyrender {

/// An image that multiplies a value, u and v of a surface times `scale` plus `offset`; v counts from the
/// bottom.
struct MtlMap {
  std::string name;
  SourceLocation location = {};  ///< of the name
  glm::dvec2 scale{1.0}, offset{0.0};
  bool clamp = false;
};

/// What a material says of itself; colours are linear Rec. 709, at least 0, as the file has them.
struct MtlMaterial {
  SourceLocation location = {};                       ///< of its name
  std::optional<glm::vec3> diffuse = std::nullopt;    ///< Kd
  std::optional<glm::vec3> specular = std::nullopt;   ///< Ks
  std::optional<glm::vec3> emission = std::nullopt;   ///< Ke
  std::optional<float> exponent = std::nullopt;       ///< Ns
  std::optional<MtlMap> diffuse_map = std::nullopt;   ///< map_Kd
  std::optional<MtlMap> specular_map = std::nullopt;  ///< map_Ks
  std::optional<MtlMap> exponent_map = std::nullopt;  ///< map_Ns
  std::int64_t illum = 0;                             ///< the number of a reflection model
};

using MtlMaterials = std::map<std::string, MtlMaterial, std::less<>>;

/// Adds the materials of `file` to `materials`. Of two with one name the first counts, as in TinyRender, with
/// a warning; unknown statements, and textures of other things, are ignored with a warning. Errors: malformed
/// colours, exponents, textures and numbers of reflection models, values before the first name.
void read_mtl(const SourceFile& file, MtlMaterials& materials, Diagnostics& diagnostics);

}  // namespace penumbra::tinyrender
