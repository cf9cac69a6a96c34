// Wavefront MTL files: the materials that OBJ files name.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>

#include "scenes/diagnostic.h"

namespace penumbra::tinyrender {

/// What a material says of itself; colours are linear Rec. 709, at least 0, as the file has them.
struct MtlMaterial {
  SourceLocation location = {};                      ///< of its name
  std::optional<glm::vec3> diffuse = std::nullopt;   ///< Kd
  std::optional<glm::vec3> specular = std::nullopt;  ///< Ks
  std::optional<glm::vec3> emission = std::nullopt;  ///< Ke
  std::optional<float> exponent = std::nullopt;      ///< Ns
  std::int64_t illum = 0;                            ///< the number of a reflection model
};

using MtlMaterials = std::map<std::string, MtlMaterial, std::less<>>;

/// Adds the materials of `file` to `materials`. Of two with one name the first counts, as in TinyRender, with
/// a warning; unknown statements and textures are ignored with a warning. Errors: malformed colours,
/// exponents and numbers of reflection models, values before the first name.
void read_mtl(const SourceFile& file, MtlMaterials& materials, Diagnostics& diagnostics);

}  // namespace penumbra::tinyrender
