#include "scenes/mikktspace.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "scenes/scene_description.h"

namespace penumbra {
namespace {

namespace blender {
struct Corner {
  glm::dvec3 position;
  glm::vec3 normal;
  glm::vec2 uv;
  glm::vec4 tangent;  ///< and sign
};
#include "tests/scenes/mikktspace.inc"
}  // namespace blender

/// Triangles of vertices of their own.
Mesh mesh_of(const std::vector<blender::Corner>& corners) {
  Mesh mesh;
  for (const blender::Corner& corner : corners) {
    mesh.positions.push_back(corner.position);
    mesh.normals.push_back(corner.normal);
    mesh.texcoords.push_back(corner.uv);
  }
  for (unsigned i = 0; i < corners.size(); i += 3) mesh.triangles.emplace_back(i, i + 1, i + 2);
  return mesh;
}

/// Blender's angles are a polynomial's, within 6.8e-5 of those of acos.
constexpr float kAngles = 7e-5f;

TEST(MikkTSpace, IsThatOfBlender) {
  const std::pair<const char*, const std::vector<blender::Corner>*> meshes[] = {
      {"globe", &blender::kGlobe},         {"skewed", &blender::kSkewed},   {"mirrored", &blender::kMirrored},
      {"collapsed", &blender::kCollapsed}, {"pinched", &blender::kPinched}, {"faceted", &blender::kFaceted}};
  for (const auto& [name, corners] : meshes) {
    const auto tangents = mikktspace_tangents(mesh_of(*corners));
    int without = 0;
    for (std::size_t i = 0; i < corners->size(); ++i) {
      SCOPED_TRACE(std::string(name) + ", corner " + std::to_string(i));
      const glm::vec4 found = tangents[i / 3][i % 3], expected = (*corners)[i].tangent;
      // Where nothing gives a tangent, Blender has (1, 0, 0).
      if (glm::vec3(found) == glm::vec3(0.0f)) {
        EXPECT_EQ(expected, glm::vec4(1, 0, 0, -1));
        ++without;
        continue;
      }
      EXPECT_LT(glm::distance(glm::vec3(found), glm::vec3(expected)), kAngles);
      EXPECT_EQ(found.w, expected.w);
    }
    EXPECT_EQ(without, corners == &blender::kCollapsed ? 6 : 0) << name;
  }
}

/// Two triangles, on which u grows along (3, -1) and (2, -1), and where they meet the mean by their angles.
TEST(MikkTSpace, IsTheMeanByAngles) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {0, -1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.texcoords = {{0, 0}, {1, 1}, {0, 2}, {0, -2}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}};
  const glm::dvec2 first = glm::normalize(glm::dvec2(3, -1)), second = glm::normalize(glm::dvec2(2, -1));
  const auto tangents = mikktspace_tangents(mesh);
  const auto expect = [](const glm::vec4& found, const glm::dvec2& sum) {
    EXPECT_LT(glm::distance(glm::dvec4(found), glm::dvec4(glm::normalize(sum), 0, 1)), 1e-6);
  };
  const double degree = std::numbers::pi / 180;
  for (const glm::vec4& shared : {tangents[0][0], tangents[1][0]})
    expect(shared, 135 * degree * first + 90 * degree * second);
  for (const glm::vec4& shared : {tangents[0][1], tangents[1][2]})
    expect(shared, std::atan(0.5) * first + 45 * degree * second);
  expect(tangents[0][2], first);
  expect(tangents[1][1], second);
}

}  // namespace
}  // namespace penumbra
