// pbrt-v4 scenes written in tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "tests/scenes/scene_text.h"

namespace penumbra::pbrt_test {

class PbrtText : public SceneText {
 protected:
  static std::string pbrt(std::string_view world, std::string_view view = "Camera \"perspective\"") {
    return std::string(view) + "\nWorldBegin\n" + std::string(world) + "\n";
  }
  Expected<SceneDescription> read_pbrt(std::string_view text, const ReadOptions& options = {}) {
    write("scene.pbrt", text);
    return read_scene(folder_ / "scene.pbrt", options);
  }
  SceneDescription good_pbrt(std::string_view world, std::string_view view = "Camera \"perspective\"",
                             const ReadOptions& options = {}) {
    return lit(good_of(read_pbrt(pbrt(world, view), options)));
  }
  std::string wrong(std::string_view world, std::string_view view = "Camera \"perspective\"") {
    return error_of(read_pbrt(pbrt(world, view)), world);
  }
  static constexpr const char* kTriangle =
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n";
  static const Mesh& mesh(const SceneDescription& scene, std::size_t index = 0) {
    return std::get<Mesh>(scene.shapes.at(index).geometry);
  }
  /// The material of a shape's front.
  static const BsdfModel& front(const SceneDescription& scene, std::size_t index = 0) {
    return scene.bsdfs.at(std::size_t(scene.shapes.at(index).front_bsdf)).model;
  }
};

inline void expect_near(glm::dvec3 a, glm::dvec3 b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

/// The front of a triangle: the side to which its winding, or being turned round, points.
inline glm::dvec3 front_normal(const SceneDescription& scene, std::size_t index = 0) {
  const Shape& shape = scene.shapes.at(index);
  const Mesh& mesh = std::get<Mesh>(shape.geometry);
  const glm::uvec3 t = mesh.triangles.at(0);
  const glm::dvec3 n = glm::normalize(
      glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
  return shape.flip_normals ? -n : n;
}

}  // namespace penumbra::pbrt_test
