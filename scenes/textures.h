// The textures. Each has its parameters, one table row for every parameter (see bsdfs.h), and the conversion
// to a record of the kernels.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <variant>

#include "kernels/scene_types.h"
#include "scenes/textures/bitmap.h"
#include "scenes/textures/checkerboard.h"
#include "scenes/textures/mesh_attribute.h"
#include "scenes/textures/noise.h"
#include "scenes/textures/scale.h"

namespace penumbra {

using TextureModel =
    std::variant<CheckerboardTexture, BitmapTexture, ScaleTexture, NoiseTexture, MeshAttributeTexture>;

struct SceneTexture {
  std::string name;  ///< the id in the scene file, or a description of the location; for messages
  TextureModel model;
  glm::dmat3 to_uv{1.0};  ///< maps homogeneous texture coordinates of the surface to those of the texture
};

inline TextureNode texture_of(const SceneTexture& texture) {
  TextureNode t = std::visit([](const auto& model) { return texture_of(model); }, texture.model);
  const glm::dmat3& m = texture.to_uv;  // column by column
  t.u_by_u = float(m[0][0]);
  t.u_by_v = float(m[1][0]);
  t.u_offset = float(m[2][0]);
  t.v_by_u = float(m[0][1]);
  t.v_by_v = float(m[1][1]);
  t.v_offset = float(m[2][1]);
  return t;
}

}  // namespace penumbra
