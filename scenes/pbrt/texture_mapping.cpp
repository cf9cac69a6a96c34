#include "scenes/pbrt/texture_mapping.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "scenes/angles.h"
#include "scenes/transform.h"

namespace penumbra::pbrt {

glm::dvec2 TextureMapping::at(const glm::dvec3& place) const {
  const glm::dvec3 p = transform_point(to_texture, place);
  const double angle = std::atan2(p.y, p.x);
  if (kind == MappingKind::kPlanar) return offset + glm::dvec2(glm::dot(p, u_axis), glm::dot(p, v_axis));
  if (kind == MappingKind::kCylindrical) return {(kPi + angle) / (2 * kPi), p.z};
  const double length = glm::length(p);
  return {length > 0 ? std::acos(std::clamp(p.z / length, -1.0, 1.0)) / kPi : 0.0,
          (angle < 0 ? angle + 2 * kPi : angle) / (2 * kPi)};
}

void map_mesh(Mesh& mesh, const TextureMapping& mapping) {
  mesh.texcoords.clear();
  for (const glm::dvec3& p : mesh.positions) mesh.texcoords.emplace_back(mapping.at(p));
  if (mapping.kind == MappingKind::kPlanar) return;
  const int turning = mapping.kind == MappingKind::kCylindrical ? 0 : 1;
  std::map<std::uint32_t, std::uint32_t> further;
  for (glm::uvec3& t : mesh.triangles) {
    float least = 1.0f, most = 0.0f;
    for (int i = 0; i < 3; ++i) {
      least = std::min(least, mesh.texcoords[t[i]][turning]);
      most = std::max(most, mesh.texcoords[t[i]][turning]);
    }
    if (most - least <= 0.5f) continue;
    for (int i = 0; i < 3; ++i) {
      if (mesh.texcoords[t[i]][turning] >= 0.5f) continue;
      const auto [known, is_new] = further.try_emplace(t[i], std::uint32_t(mesh.positions.size()));
      if (is_new) {
        mesh.positions.push_back(glm::dvec3(mesh.positions[t[i]]));
        mesh.texcoords.push_back(glm::vec2(mesh.texcoords[t[i]]));
        mesh.texcoords.back()[turning] += 1.0f;
        if (!mesh.normals.empty()) mesh.normals.push_back(glm::vec3(mesh.normals[t[i]]));
        if (!mesh.colours.empty()) mesh.colours.push_back(glm::vec3(mesh.colours[t[i]]));
      }
      t[i] = known->second;
    }
  }
}

}  // namespace penumbra::pbrt
