// Where textures of pbrt are by the places of a surface, not by its texture coordinates.
#pragma once

#include <glm/glm.hpp>

#include "scenes/scene_description.h"

namespace penumbra::pbrt {

enum class MappingKind { kSpherical, kCylindrical, kPlanar };

struct TextureMapping {
  MappingKind kind = MappingKind::kPlanar;
  glm::dmat4 to_texture{1.0};                               ///< from the world
  glm::dvec3 u_axis{1.0, 0.0, 0.0}, v_axis{0.0, 1.0, 0.0};  ///< planar
  glm::dvec2 offset{0.0};                                   ///< planar

  /// Of a place in the world.
  [[nodiscard]] glm::dvec2 at(const glm::dvec3& place) const;
  friend bool operator==(const TextureMapping&, const TextureMapping&) = default;
};

/// Gives a mesh of the world such coordinates at its vertices. Triangles across the seam of a sphere or a
/// cylinder get vertices of their own, a turn further.
void map_mesh(Mesh& mesh, const TextureMapping& mapping);

}  // namespace penumbra::pbrt
