// Texture mappings of pbrt that use positions on a surface instead of its texture coordinates.
#pragma once

#include <glm/glm.hpp>

#include "scenes/scene_description.h"

namespace penumbra::pbrt {

enum class MappingKind { kSpherical, kCylindrical, kPlanar };

struct TextureMapping {
  MappingKind kind = MappingKind::kPlanar;
  glm::dmat4 to_texture{1.0};                               ///< from world space
  glm::dvec3 u_axis{1.0, 0.0, 0.0}, v_axis{0.0, 1.0, 0.0};  ///< axes of a planar mapping
  glm::dvec2 offset{0.0};                                   ///< of a planar mapping

  /// The texture coordinates of a position in world space.
  [[nodiscard]] glm::dvec2 at(const glm::dvec3& place) const;
  friend bool operator==(const TextureMapping&, const TextureMapping&) = default;
};

/// Gives the vertices of a mesh in world space the texture coordinates of the mapping. Triangles across the
/// seam of a spherical or cylindrical mapping get vertices of their own, with coordinates shifted by a full
/// turn.
void map_mesh(Mesh& mesh, const TextureMapping& mapping);

}  // namespace penumbra::pbrt
