#include "tests/benchmarks/bumpy_room.h"

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <initializer_list>

#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

constexpr int kWhite = 0;
constexpr double kBallRadius = 0.5, kBumps = 20, kBumpHeight = 0.1;

void add_quad(Mesh& mesh, std::initializer_list<glm::dvec3> corners) {
  const auto first = unsigned(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), corners);
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

/// The cube [-1, 1]^3 from inside.
Mesh room() {
  Mesh mesh;
  for (const double side : {-1.0, 1.0}) {
    add_quad(mesh, {{side, -1, -1}, {side, 1, -1}, {side, 1, 1}, {side, -1, 1}});
    add_quad(mesh, {{-1, side, -1}, {1, side, -1}, {1, side, 1}, {-1, side, 1}});
    add_quad(mesh, {{-1, -1, side}, {1, -1, side}, {1, 1, side}, {-1, 1, side}});
  }
  return mesh;
}

glm::dvec3 ball_point(double polar, double azimuth) {
  const double r = kBallRadius * (1 + kBumpHeight * std::sin(kBumps * polar) * std::sin(kBumps * azimuth));
  return {r * std::sin(polar) * std::cos(azimuth), r * std::cos(polar),
          r * std::sin(polar) * std::sin(azimuth)};
}

Mesh ball(int triangles) {
  const auto side = unsigned(std::sqrt(double(triangles) / 2));
  Mesh mesh;
  for (unsigned i = 0; i <= side; ++i)
    for (unsigned j = 0; j <= side; ++j)
      mesh.positions.push_back(ball_point(glm::pi<double>() * i / side, 2 * glm::pi<double>() * j / side));
  for (unsigned i = 0; i < side; ++i)
    for (unsigned j = 0; j < side; ++j) {
      const unsigned a = i * (side + 1) + j, below = a + side + 1;
      mesh.triangles.push_back({a, a + 1, below});
      mesh.triangles.push_back({a + 1, below + 1, below});
    }
  return mesh;
}

Shape two_sided(const char* name, Mesh mesh) {
  Shape shape;
  shape.name = name;
  shape.geometry = std::move(mesh);
  shape.front_bsdf = shape.back_bsdf = kWhite;
  return shape;
}

}  // namespace

SceneDescription bumpy_room(int ball_triangles) {
  SceneDescription scene;
  scene.source = "bumpy room";
  scene.bsdfs.push_back({"white", DiffuseBsdf{glm::vec3(0.7f)}});
  scene.shapes.push_back(two_sided("room", room()));
  scene.shapes.push_back(two_sided("ball", ball(ball_triangles)));
  Mesh light;
  add_quad(light, {{-0.4, 0.98, -0.4}, {0.4, 0.98, -0.4}, {0.4, 0.98, 0.4}, {-0.4, 0.98, 0.4}});
  scene.shapes.push_back(two_sided("light", std::move(light)));
  scene.shapes.back().radiance = glm::vec3(4.0f);
  // From (0, 0, -0.95) along +z.
  scene.camera.to_world[3] = glm::dvec4(0, 0, -0.95, 1);
  scene.camera.fov = 80;
  scene.film.width = scene.film.crop_width = 512;
  scene.film.height = scene.film.crop_height = 512;
  param::max_depth(scene.integrator) = 6;
  return scene;
}

}  // namespace penumbra
