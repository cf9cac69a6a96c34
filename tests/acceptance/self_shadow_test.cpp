// No surface shadows itself, with either intersector, at any position and size: under a white sky, every path
// on a plane reflects exactly the albedo.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::self_shadow_test {
namespace {

using glm::dvec3;

constexpr int kPixels = 20;
constexpr float kAlbedo = 0.5f;

struct Placed {
  std::string name;
  double scale;
  dvec3 center;  ///< in units of the scale
  bool embree;
};
void PrintTo(const Placed& placed, std::ostream* out) { *out << placed.name; }

/// A square of cells x cells, each of two triangles, on both sides of its centre.
Shape grid(const dvec3& center, const dvec3& u, const dvec3& v, int cells) {
  Mesh mesh;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j)
      mesh.positions.push_back(center + (2.0 * i / cells - 1) * u + (2.0 * j / cells - 1) * v);
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      const unsigned k = unsigned(i * (cells + 1) + j), next = k + unsigned(cells) + 1;
      mesh.triangles.emplace_back(k, next, next + 1);
      mesh.triangles.emplace_back(k, next + 1, k + 1);
    }
  Shape shape;
  shape.name = "plane";
  shape.geometry = std::move(mesh);
  shape.front_bsdf = shape.back_bsdf = 0;
  return shape;
}

class SelfShadow : public testing::TestWithParam<Placed> {};

/// Seen from both sides of a plane through the centre of the scene, which `balance` moves off it.
void expect_albedo(const Placed& placed, const dvec3& normal, int cells, double balance) {
  const dvec3 aside = std::abs(normal.y) > 0.9 ? dvec3(0, 0, 1) : dvec3(0, 1, 0);
  const dvec3 u = glm::normalize(glm::cross(aside, normal)), v = glm::cross(normal, u);
  const double scale = placed.scale;
  const dvec3 center = placed.center * scale;
  for (const double side : {-1.0, 1.0})
    for (const DirectSampling sampling : {DirectSampling::kBsdfOnly, DirectSampling::kMis}) {
      SceneDescription scene = empty_scene(kPixels, kPixels, 32, 1);
      scene.camera = look_at(center + scale * (side * normal + 0.8 * u + 0.3 * v), center, v, 40);
      scene.camera.near_clip = 1e-4 * scale;
      scene.camera.far_clip = 100 * scale;
      scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
      add_diffuse(scene, kAlbedo);
      scene.shapes.push_back(grid(center, 2 * scale * u, 2 * scale * v, cells));
      if (balance != 0) {  // out of sight, and as bright as the sky behind it
        scene.shapes.push_back(grid(center + scale * (balance * normal + 90.0 * u), scale * u, scale * v, 1));
        scene.shapes.back().radiance = glm::vec3(1);
        scene.shapes.back().two_sided_emission = true;
      }
      scene.integrator = path_integrator(sampling);
      param::max_depth(scene.integrator) = 2;
      TestDevice device = native_device();
      device.embree = placed.embree;
      const FilmAccumulator film = render_or_throw(scene, device);
      double sum = 0;
      for (int y = 0; y < kPixels; ++y)
        for (int x = 0; x < kPixels; ++x) {
          sum += film.at(x, y).mean[1] / (kPixels * kPixels);
          if (sampling == DirectSampling::kBsdfOnly)
            ASSERT_NEAR(film.at(x, y).mean[1], kAlbedo, 1e-6)
                << x << ", " << y << " of " << cells << " cells, normal " << normal.x << ", " << normal.y;
        }
      EXPECT_NEAR(sum, kAlbedo, 0.01);
    }
}

TEST_P(SelfShadow, APlaneUnderTheSkyReflectsItsAlbedo) {
  const double tiny = 1e-4;
  for (const dvec3& direction : {dvec3(0, 1, 0), dvec3(1, 0, 0), dvec3(0, 0, -1), dvec3(0.2, 1, 0.1),
                                 dvec3(tiny, 1, 0), dvec3(-0.7, 0.4, 0.6)})
    for (const int cells : {1, 2, 7})
      for (const double balance : {0.0, 40.0})
        expect_albedo(GetParam(), glm::normalize(direction), cells, balance);
}

std::vector<Placed> places() {
  std::vector<Placed> all;
  for (const bool embree : {false, true})
    for (const auto& [name, scale] : {std::pair{"Tiny", 1e-4}, {"", 1.0}, {"Huge", 1e5}})
      for (const auto& [where, center] :
           {std::pair{"Centred", dvec3(0)}, {"Shifted", dvec3(7.3, -120.7, 31.9)}})
        all.push_back({std::string(embree ? "Embree" : "Portable") + name + where, scale, center, embree});
  return all;
}

INSTANTIATE_TEST_SUITE_P(Places, SelfShadow, testing::ValuesIn(places()),
                         [](const auto& placed) { return placed.param.name; });

}  // namespace
}  // namespace penumbra::self_shadow_test
