// A diffuse floor under one triangle light: five exact pixel values, which every strategy must reproduce.
#include <gtest/gtest.h>

#include <array>

#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/strategies.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

constexpr double kSignificance = 0.01;
constexpr std::uint32_t kSamples = 100'000;
constexpr double kRounding = 32.0 / (1 << 24);  ///< see furnace_test.cpp

struct PolygonLight {
  std::array<glm::dvec3, 3> vertices;
  double radiance;  ///< of the floor at the origin
};

const std::array<PolygonLight, 5> kLights{{
    {{{{-.443432, .596366, .495985}, {-.320397, .0677699, -.229359}, {.0341197, .11415, -.343049}}},
     0.089839259},
    {{{{.461963, .397843, .412747}, {-.0381582, .851323, -.156872}, {.195443, .891957, -.260672}}},
     0.022920040},
    {{{{.100871, .289075, -.422609}, {-.308386, .629587, .423966}, {-.373132, .237287, .351592}}},
     0.053419540},
    {{{{-.17575, .639397, .151268}, {.318604, .732996, .459771}, {.139095, .294498, .478556}}}, 0.020531391},
    {{{{-.17487, .447916, .367201}, {-.405259, .249607, -.354079}, {.356029, .0918984, -.132271}}},
     0.261739859},
}};

SceneDescription floor_under(const PolygonLight& light) {
  SceneDescription scene = empty_scene(1, 1, kSamples, 1);
  scene.camera = look_at(glm::dvec3(0, 0.01, 0), glm::dvec3(0), glm::dvec3(0, 0, 1), 1e-6);
  scene.shapes.push_back(parallelogram({-10, 0, -10}, {0, 0, 20}, {20, 0, 0}, add_diffuse(scene, 0.5f)));
  std::array<glm::dvec3, 3> vertices = light.vertices;
  // The front, which emits, has to face the origin.
  if (glm::dot(glm::cross(vertices[1] - vertices[0], vertices[2] - vertices[0]), -vertices[0]) < 0) {
    std::swap(vertices[1], vertices[2]);
  }
  scene.shapes.push_back(triangles(vertices, add_diffuse(scene, 0), 1));
  return scene;
}

class PolygonLights : public testing::TestWithParam<Strategy> {};

TEST_P(PolygonLights, ExactRadiance) {
  TestDevice device = native_device();
  device.samples_per_pass = kMaxSamplesPerUnit;
  for (std::size_t i = 0; i < kLights.size(); ++i) {
    SceneDescription scene = floor_under(kLights[i]);
    scene.integrator = GetParam().integrator;
    const FilmAccumulator film = render_or_throw(scene, device);
    const statistics::Sample sample = pixel_sample(film, 0, 0, 1);
    ASSERT_EQ(sample.count(), kSamples);
    EXPECT_GT(sample.standard_error(), 0);
    EXPECT_GT(statistics::t_test(sample, kLights[i].radiance, kLights[i].radiance * kRounding).p,
              kSignificance)
        << "light " << i + 1 << ": " << sample.mean() << " +- " << sample.standard_error() << ", exactly "
        << kLights[i].radiance;
  }
}

INSTANTIATE_TEST_SUITE_P(Strategies, PolygonLights, testing::ValuesIn(all_strategies()),
                         [](const auto& info) { return strategy_name(info); });

}  // namespace
}  // namespace penumbra
