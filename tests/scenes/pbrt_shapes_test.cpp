// Shapes of pbrt-v4 beside meshes: quadrics and parts of them, curves, subdivision surfaces.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "scenes/pbrt/bspline_curves.h"
#include "scenes/pbrt/loop_subdivision.h"
#include "scenes/pbrt/quadric_mesh.h"
#include "tests/scenes/pbrt_text.h"

namespace penumbra::pbrt_test {
namespace {

using ::testing::HasSubstr;
using PbrtShapes = PbrtText;

double area_of(const Mesh& mesh) {
  double area = 0;
  for (const glm::uvec3& t : mesh.triangles)
    area += 0.5 * glm::length(glm::cross(mesh.positions[t.y] - mesh.positions[t.x],
                                         mesh.positions[t.z] - mesh.positions[t.x]));
  return area;
}

/// The least cosine between a triangle's normal and those of its corners.
double least_cosine(const Mesh& mesh) {
  double least = 1;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 n = glm::normalize(
        glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
    for (int i = 0; i < 3; ++i) least = std::min(least, glm::dot(n, glm::dvec3(mesh.normals.at(t[i]))));
  }
  return least;
}

TEST_F(PbrtShapes, Cylinders) {
  const SceneDescription scene = good_pbrt(
      "Translate 1 2 3\nRotate 90 0 1 0\nScale 2 2 4\nShape \"cylinder\" \"float radius\" 3 \"float zmin\" 1 "
      "\"float zmax\" 2\n");
  const auto& cylinder = std::get<Cylinder>(scene.shapes.at(0).geometry);
  expect_near(cylinder.center, {5, 2, 3});
  expect_near(cylinder.axis, {1, 0, 0});
  EXPECT_NEAR(cylinder.radius, 6, 1e-12);
  EXPECT_NEAR(cylinder.length, 4, 1e-12);
  EXPECT_THAT(wrong("Shape \"cylinder\" \"float zmin\" 1 \"float zmax\" 1"), HasSubstr("are both at 1"));
}

TEST_F(PbrtShapes, PartsOfQuadricsAreMeshes) {
  const SceneDescription scene = good_pbrt(
      "Shape \"sphere\" \"float radius\" 2 \"float zmin\" -1 \"float zmax\" 1 \"float phimax\" 90\n"
      "Shape \"disk\" \"float radius\" 2 \"float innerradius\" 1 \"float height\" 3\n"
      "Shape \"cylinder\" \"float phimax\" 180\n");
  const double pi = std::numbers::pi;
  // A zone's area is 2 pi r h.
  EXPECT_NEAR(area_of(mesh(scene, 0)), 2 * pi * 2 * 2 / 4, 2e-3);
  EXPECT_NEAR(area_of(mesh(scene, 1)), pi * (4 - 1), 3e-3);
  EXPECT_NEAR(area_of(mesh(scene, 2)), 2 * pi, 1e-3);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_GT(least_cosine(mesh(scene, i)), 0.999) << i;
  expect_near(front_normal(scene, 1), {0, 0, 1});
  for (const glm::dvec3& p : mesh(scene, 0).positions) EXPECT_TRUE(p.x > -1e-9 && p.y > -1e-9);
}

TEST_F(PbrtShapes, StretchedSpheresAreMeshes) {
  const SceneDescription scene =
      good_pbrt("Translate 0 0 5\nScale 1 2 -3\nShape \"sphere\" \"float radius\" 2\n");
  for (const glm::dvec3& p : mesh(scene).positions)
    EXPECT_NEAR(p.x * p.x / 4 + p.y * p.y / 16 + (p.z - 5) * (p.z - 5) / 36, 1, 1e-9);
  EXPECT_GT(least_cosine(mesh(scene)), 0.995);
  EXPECT_EQ(warnings(scene), "");
}

glm::dvec3 at(const Curve& curve, std::size_t piece, double t) {
  const double s = 1 - t;
  const double w[] = {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6,
                      t * t * t / 6};
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < 4; ++i) sum += w[i] * curve[piece + i].position;
  return sum;
}

TEST(PbrtCurves, AreTheSamePolynomials) {
  const std::vector<glm::dvec3> points = {{0, 0, 0}, {1, 2, 0}, {3, 1, 1}, {4, 0, 2}};
  const auto bezier = pbrt::bspline_curves(points, {true, 3, 2.0, 1.0});
  ASSERT_EQ(bezier.size(), 1u);
  const double t = 0.3, s = 1 - t;
  expect_near(at(bezier[0], 0, t), s * s * s * points[0] + 3 * s * s * t * points[1] +
                                       3 * s * t * t * points[2] + t * t * t * points[3]);
  // Linear radii of control points: 2 at the start, 1 at the end.
  EXPECT_NEAR((bezier[0][0].radius + 4 * bezier[0][1].radius + bezier[0][2].radius) / 6, 2, 1e-12);
  EXPECT_NEAR((bezier[0][1].radius + 4 * bezier[0][2].radius + bezier[0][3].radius) / 6, 1, 1e-12);
  const std::vector<glm::dvec3> square(points.begin(), points.begin() + 3);
  expect_near(at(pbrt::bspline_curves(square, {true, 2, 1, 1})[0], 0, t),
              s * s * points[0] + 2 * s * t * points[1] + t * t * points[2]);
  EXPECT_EQ(pbrt::bspline_curves(points, {false, 3, 1, 1})[0].size(), 4u);
  const auto pieces = pbrt::bspline_curves(points, {false, 2, 1, 1});
  ASSERT_EQ(pieces.size(), 2u);
  expect_near(at(pieces[0], 0, 1), at(pieces[1], 0, 0));
  expect_near(at(pieces[0], 0, 0), 0.5 * (points[0] + points[1]));
}

TEST_F(PbrtShapes, CurvesInARowAreOneShape) {
  const auto curve = [](const std::string& type) {
    return "Shape \"curve\" \"string type\" \"" + type +
           "\" \"point3 P\" [0 0 0 0 0 1 0 0 2 0 0 3] \"float width\" 0.5\n";
  };
  const SceneDescription scene = good_pbrt(curve("cylinder") + curve("cylinder") + curve("flat") +
                                           "Scale 2 2 2\nMaterial \"diffuse\"\n" + curve("flat"));
  ASSERT_EQ(scene.shapes.size(), 3u);
  const auto curves = [&](std::size_t i) { return std::get<Curves>(scene.shapes[i].geometry); };
  EXPECT_EQ(curves(0).form, CurveForm::kCylinder);
  EXPECT_EQ(curves(0).curves.size(), 2u);
  EXPECT_EQ(curves(0).ranges.size(), 2u);
  EXPECT_EQ(curves(1).form, CurveForm::kFlat);
  EXPECT_NEAR(curves(1).curves.at(0).at(1).radius, 0.25, 1e-12);
  EXPECT_NEAR(curves(2).curves.at(0).at(1).radius, 0.5, 1e-12) << "scaled";
  EXPECT_THAT(wrong("Shape \"curve\" \"point3 P\" [0 0 0 1 1 1]"), HasSubstr("a curve of 2 points"));
  // What emits is of triangles.
  const SceneDescription light = good_pbrt("AreaLightSource \"diffuse\"\n" + curve("cylinder"));
  EXPECT_NEAR(area_of(mesh(light, 0)), std::numbers::pi * 0.5 * 3, 0.01);
}

TEST(PbrtSubdivision, OfAnOctahedronIsRound) {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    mesh.triangles.emplace_back(i, (i + 1) % 4, 4);
    mesh.triangles.emplace_back((i + 1) % 4, i, 5);
  }
  const auto fine = pbrt::loop_subdivided(mesh, 3);
  ASSERT_TRUE(fine);
  EXPECT_EQ(fine->triangles.size(), 8u * 64);
  // Of a vertex of 4 neighbours at 0 in sum, the limit is p (1 - 4 gamma), gamma = 1 / (4 + 3 / (8 beta)),
  // beta = 3/32.
  EXPECT_NEAR(fine->positions[0].x, 0.5, 1e-12);
  for (const glm::dvec3& p : fine->positions) EXPECT_NEAR(glm::length(p), 0.46, 0.045);
  // Points of the limit surface stay where they are.
  const auto coarse = pbrt::loop_subdivided(mesh, 2);
  for (std::size_t i = 0; i < coarse->positions.size(); ++i)
    expect_near(fine->positions[i], coarse->positions[i]);
}

TEST(PbrtSubdivision, OfAPlaneIsTheSamePlane) {
  Mesh mesh;
  mesh.positions = {{0, 0, 1}, {3, 0, 1}, {3, 3, 1}, {0, 3, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const auto fine = pbrt::loop_subdivided(mesh, 2);
  ASSERT_TRUE(fine);
  EXPECT_EQ(fine->triangles.size(), 32u);
  for (const glm::dvec3& p : fine->positions) EXPECT_NEAR(p.z, 1, 1e-12);
  const auto coarse = pbrt::loop_subdivided(mesh, 1);
  for (std::size_t i = 0; i < coarse->positions.size(); ++i)
    expect_near(fine->positions[i], coarse->positions[i]);
  mesh.triangles.emplace_back(0, 2, 1);
  mesh.triangles.emplace_back(2, 0, 1);
  EXPECT_THAT(pbrt::loop_subdivided(mesh, 1).error().message, HasSubstr("more than two triangles"));
}

}  // namespace
}  // namespace penumbra::pbrt_test
