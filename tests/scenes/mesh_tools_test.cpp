#include "scenes/mesh_tools.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scenes/transform.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

glm::dvec3 face_normal(const Mesh& mesh, std::size_t i) {
  const glm::uvec3& t = mesh.triangles[i];
  const glm::dvec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
  return glm::normalize(glm::cross(b - a, c - a));
}

double area(const Mesh& mesh) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    sum += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  return sum;
}

/// The cube of eight shared vertices: every vertex normal is along a diagonal.
Mesh shared_cube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.push_back({i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
  const unsigned quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

const std::vector<glm::dmat4> kTransforms = {
    glm::dmat4(1.0),         scaling({-1, 1, 1}),
    scaling({1, 1, -1}),     scaling({-1, -1, -1}),
    scaling({1e-4, 3, 200}), translation({1e6, 2, 3}) * rotation({1, 2, 3}, 50) * scaling({2, -0.5, 1})};

TEST(Rectangle, FrontFollowsTheTransformedNormal) {
  for (const glm::dmat4& m : kTransforms) {
    const Mesh mesh = make_rectangle(m);
    const glm::dvec3 expected = glm::normalize(normal_matrix(m) * glm::dvec3(0, 0, 1));
    ASSERT_THAT(mesh.triangles, SizeIs(2));
    EXPECT_THAT(mesh.normals, IsEmpty());
    for (std::size_t i = 0; i < 2; ++i) EXPECT_GT(glm::dot(face_normal(mesh, i), expected), 1.0 - 1e-9);
    const double expected_area =
        4.0 * glm::length(glm::cross(transform_vector(m, {1, 0, 0}), transform_vector(m, {0, 1, 0})));
    EXPECT_NEAR(area(mesh), expected_area, 1e-9 * expected_area);
  }
}

TEST(Cube, FrontIsOutside) {
  for (const glm::dmat4& m : kTransforms) {
    const Mesh mesh = make_cube(m);
    ASSERT_THAT(mesh.triangles, SizeIs(12));
    for (std::size_t i = 0; i < 12; ++i) {
      const glm::dvec3 center = mesh.positions[mesh.triangles[i].x] - transform_point(m, glm::dvec3(0.0));
      EXPECT_GT(glm::dot(face_normal(mesh, i), center), 0.0) << "triangle " << i;
    }
  }
  EXPECT_NEAR(area(make_cube(glm::dmat4(1.0))), 24.0, 1e-12);
}

TEST(PlaceMesh, SmoothNormalsAreAngleWeighted) {
  Mesh mesh = shared_cube();
  ASSERT_TRUE(place_mesh(mesh, glm::dmat4(1.0), false));
  ASSERT_THAT(mesh.normals, SizeIs(8));
  // However each face is split in two, each has a right angle at each corner.
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_LT(glm::distance(mesh.normals[i], glm::normalize(glm::vec3(mesh.positions[i]))), 1e-6f);
  }
}

TEST(PlaceMesh, WithoutNormalsTheWindingTurnsWithAMirror) {
  for (const bool face_normals : {true, false}) {
    Mesh mesh = shared_cube();
    ASSERT_TRUE(place_mesh(mesh, scaling({-1, 1, 1}), face_normals));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      EXPECT_LT(glm::dot(face_normal(mesh, i), mesh.positions[mesh.triangles[i].x]), 0.0);
    }
    EXPECT_EQ(mesh.normals.empty(), face_normals);
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
      EXPECT_LT(glm::dot(mesh.normals[i], glm::vec3(mesh.positions[i])), 0.0f);
    }
  }
}

TEST(PlaceMesh, WindingAgreesWithVertexNormals) {
  for (const glm::dmat4& m : kTransforms) {
    Mesh mesh = shared_cube();
    for (const glm::dvec3& p : mesh.positions) mesh.normals.push_back(glm::vec3(p) * 3.0f);
    std::swap(mesh.triangles[3].x, mesh.triangles[3].y);  // one that is wound the wrong way
    ASSERT_TRUE(place_mesh(mesh, m, false));
    const glm::dvec3 center = transform_point(m, glm::dvec3(0.0));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      EXPECT_GT(glm::dot(face_normal(mesh, i), mesh.positions[mesh.triangles[i].x] - center), 0.0);
    }
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
      const glm::dvec3 expected =
          glm::normalize(normal_matrix(m) * glm::normalize(shared_cube().positions[i]));
      EXPECT_LT(glm::distance(glm::dvec3(mesh.normals[i]), expected), 1e-6);
    }
  }
}

TEST(PlaceMesh, FlatMeshesStayFaceted) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  ASSERT_TRUE(place_mesh(mesh, rotation({1, 2, 3}, 33), false));
  EXPECT_THAT(mesh.normals, IsEmpty());
}

TEST(PlaceMesh, FaceNormalsDropTheOthers) {
  Mesh mesh = shared_cube();
  mesh.normals.assign(8, {0, 0, 1});
  ASSERT_TRUE(place_mesh(mesh, glm::dmat4(1.0), true));
  EXPECT_THAT(mesh.normals, IsEmpty());
}

TEST(PlaceMesh, LeavesOutTrianglesWithoutAreaAndKeepsSlivers) {
  for (const double scale : {1e-30, 1e-5, 1.0, 1e8, 1e30}) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0},       {0.5, 1e-7, 0}, {2, 0, 0},
                      {0, 0, 0}, {0.1, 0.2, 0.3}, {0.3, 0.6, 0.9}};
    mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 4, 2}, {1, 1, 2}, {0, 5, 6}, {0, 0, 0}};
    const auto cleaning = place_mesh(mesh, scaling(glm::dvec3(scale)), false);
    if (scale < 1e-20 || scale > 1e20) {
      ASSERT_FALSE(cleaning);
      EXPECT_THAT(cleaning.error().message, HasSubstr("for single precision"));
      continue;
    }
    ASSERT_TRUE(cleaning);
    EXPECT_EQ(cleaning->flat_triangles, 5u) << scale;
    EXPECT_THAT(mesh.triangles, SizeIs(1));
  }
}

TEST(PlaceMesh, ReplacesBadNormals) {
  Mesh mesh = shared_cube();
  for (const glm::dvec3& p : mesh.positions) mesh.normals.push_back(glm::vec3(p));
  mesh.normals[2] = {0, 0, 0};
  mesh.normals[5] = {HUGE_VALF, 0, 0};
  const auto cleaning = place_mesh(mesh, glm::dmat4(1.0), false);
  ASSERT_TRUE(cleaning);
  EXPECT_EQ(cleaning->bad_normals, 2u);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_LT(glm::distance(mesh.normals[i], glm::normalize(glm::vec3(mesh.positions[i]))), 1e-6f);
  }
}

TEST(PlaceMesh, OverflowIsAnError) {
  Mesh mesh = shared_cube();
  EXPECT_FALSE(place_mesh(mesh, scaling(glm::dvec3(1e38)), false));
  Mesh infinite = shared_cube();
  EXPECT_FALSE(place_mesh(infinite, translation({1e300, 0, 0}) * scaling(glm::dvec3(1e300)), false));
}

TEST(FaceNormals, GoIfTheyAreTheFacesButForRounding) {
  Mesh mesh = make_rectangle(rotation({1, 2, 3}, 40));
  const auto give = [&](double sine) {
    const glm::dvec3 n = face_normal(mesh, 0), across = glm::normalize(mesh.positions[1] - mesh.positions[0]);
    mesh.normals.assign(4, glm::vec3(n));
    mesh.normals[2] = glm::vec3(std::sqrt(1.0 - sine * sine) * n + sine * across);
  };
  drop_face_normals(mesh);
  EXPECT_THAT(mesh.normals, IsEmpty());
  for (const double sine : {0.0, 1e-4, 9e-4}) {
    give(sine);
    drop_face_normals(mesh);
    EXPECT_THAT(mesh.normals, IsEmpty()) << sine;
  }
  for (const double sine : {1.1e-3, 0.1, 1.0}) {
    give(sine);
    drop_face_normals(mesh);
    EXPECT_THAT(mesh.normals, SizeIs(4)) << sine;
  }
  give(0.0);
  for (glm::vec3& n : mesh.normals) n = -n;
  drop_face_normals(mesh);
  EXPECT_THAT(mesh.normals, SizeIs(4)) << "the back's";
}

}  // namespace
}  // namespace penumbra
