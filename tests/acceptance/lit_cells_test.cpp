// Surfaces that see every light whole: their light in closed form, without bias whatever is about them.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/shadowed_polygon.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::lit_cells_test {
namespace {

using glm::dvec3;

constexpr double kSignificance = 0.01;
constexpr int kSide = 16;  ///< of the film
constexpr int kBatches = 48;
/// Of radiance: positions that samples start from are rounded, those of closed forms are not.
constexpr double kRounding = 2e-5;

struct Place {
  std::string name;
  SceneDescription scene;
};
void PrintTo(const Place& place, std::ostream* out) { *out << place.name; }

/// The integrators that tests make sample every light.
IntegratorSettings with_cells(IntegratorSettings direct) {
  std::get<DirectIntegrator>(direct.method).closed_where_lit = true;
  return direct;
}
void sample_all(SceneDescription& scene) {
  std::get<DirectIntegrator>(scene.integrator.method).closed_where_lit = false;
}

/// A floor with a step, a slab above it and a light, seen from the side.
SceneDescription under_an_area_light() {
  SceneDescription scene = empty_scene(kSide, kSide, 128, 1);
  scene.camera = look_at({5, -4, 3.5}, {0, 0, 0.3}, {0, 0, 1}, 50);
  scene.integrator = with_cells(direct_integrator(2, 0));
  const int grey = add_diffuse(scene, 0.7f);
  scene.shapes = {parallelogram({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, grey),
                  parallelogram({-1, -1, 0.8}, {1.4, 0.1, 0.2}, {-0.1, 1.1, 0.1}, grey),
                  parallelogram({-4, 2, 0}, {8, 0, 0}, {0, 0, 2}, grey)};
  return scene;
}

Shape area_light() {  // concave, of four triangles
  const dvec3 a(-0.6, -0.5, 3), b(-0.5, 0.6, 3), c(0.1, 0, 3), d(0.6, 0.6, 3), e(0.5, -0.5, 3);
  return triangles(std::array{a, b, c, a, c, e, c, d, e}, kBlackBsdf, 4);
}

std::vector<Place> places() {
  std::vector<Place> all;
  const auto add = [&](const char* name) -> SceneDescription& {
    all.push_back({name, under_an_area_light()});
    return all.back().scene;
  };
  add("AConcaveAreaLight").shapes.push_back(area_light());
  SceneDescription& area_lights = add("SeveralAreaLights");
  area_lights.shapes.push_back(area_light());
  area_lights.shapes.push_back(parallelogram({-3, -3, 1}, {0, 1, 0}, {0.5, 0, 0.7}, kBlackBsdf, 2));
  SceneDescription& two_sided = add("AnAreaLightOnTheFloor");
  two_sided.shapes.push_back(parallelogram({1, -2, -0.3}, {0.8, 0.3, 0}, {0, 0, 1.2}, kBlackBsdf, 3));
  two_sided.shapes.back().two_sided_emission = true;
  SceneDescription& grey_area_light = add("AnAreaLightThatReflects");
  grey_area_light.shapes.push_back(area_light());
  grey_area_light.shapes.back().front_bsdf = 0;
  grey_area_light.shapes.push_back(parallelogram({1, -2, 0.2}, {0.8, 0.3, 0}, {0, 0, 1.2}, 0, 3));
  SceneDescription& phong = add("OnPhong");
  phong.bsdfs[0].model = PhongBsdf{glm::vec3(0.4f), glm::vec3(0.3f), 20};
  phong.shapes.push_back(area_light());
  SceneDescription& mis = add("BesideDirections");
  mis.integrator = with_cells(direct_integrator(1, 1));
  mis.shapes.push_back(area_light());
  SceneDescription& rectangle = add("BySolidAngle");
  rectangle.integrator = with_cells(emitter_only(EmitterSampling::kSolidAngle, 1));
  rectangle.shapes.push_back(parallelogram({-0.5, -0.5, 3}, {0, 1, 0}, {1, 0, 0}, kBlackBsdf, 4));
  SceneDescription& smooth = add("OnSmoothNormals");
  auto& wall = std::get<Mesh>(smooth.shapes[2].geometry);
  for (std::size_t k = 0; k < wall.positions.size(); ++k)
    wall.normals.push_back(glm::normalize(glm::vec3(k % 2 == 0 ? 0.5f : -0.5f, -1, 0.3f)));
  smooth.shapes.push_back(area_light());
  SceneDescription& lens = add("ThroughALens");
  lens.camera.aperture_radius = 0.2;
  lens.camera.focus_distance = 5;
  lens.shapes.push_back(area_light());
  SceneDescription& sphere = add("BesideASphere");
  Shape ball;
  ball.name = "ball";
  ball.geometry = Sphere{{1.5, -0.5, 0.5}, 0.5};
  ball.front_bsdf = ball.back_bsdf = 0;
  sphere.shapes.push_back(ball);
  sphere.shapes.push_back(area_light());
  return all;
}

bool has_lit_cells(const SceneDescription& scene) {
  return (build_or_throw(scene).header.features & FEATURE_LIT_CELLS) != 0u;
}

class LitCellsPlace : public testing::TestWithParam<Place> {};
INSTANTIATE_TEST_SUITE_P(Places, LitCellsPlace, testing::ValuesIn(places()),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(LitCellsPlace, HasTheMeanOfSamples) {
  SceneDescription closed = GetParam().scene, sampled = closed;
  EXPECT_TRUE(has_lit_cells(closed));
  sample_all(sampled);
  EXPECT_FALSE(has_lit_cells(sampled));
  // By the same camera rays: what differs is light alone.
  std::vector<statistics::Sample> differences(std::size_t{kSide} * kSide), radiance = differences;
  double noise = 0, of_samples = 0;
  for (int batch = 0; batch < kBatches; ++batch) {
    closed.sampler.seed = sampled.sampler.seed = std::uint32_t(batch);
    const FilmAccumulator a = render_or_throw(closed), b = render_or_throw(sampled);
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const double at_a = pixel_sample(a, x, y, 1).mean(), at_b = pixel_sample(b, x, y, 1).mean();
        differences[std::size_t(y * kSide + x)].add(at_a - at_b);
        radiance[std::size_t(y * kSide + x)].add(at_b);
      }
    noise += mean_variance(a);
    of_samples += mean_variance(b);
  }
  ManyTests tests;
  int lit = 0;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    if (differences[i].variance() == 0) continue;  // no cell, or no light
    tests.add(statistics::t_test(differences[i], 0, kRounding * radiance[i].mean()),
              "pixel " + std::to_string(i % kSide) + ", " + std::to_string(i / kSide));
    ++lit;
  }
  tests.expect_passed(kSignificance);
  EXPECT_GT(lit, kSide * kSide / 4);
  EXPECT_LT(noise, of_samples);
}

TEST(LitCells, ImagesAreTheSameOnEveryDevice) {
  for (Place& place : places()) {
    place.scene.sampler.spp = 4;
    const DeviceScene scene = build_or_throw(place.scene), embree = build_or_throw(place.scene, true);
    ASSERT_NE(scene.header.features & FEATURE_LIT_CELLS, 0u) << place.name;
    const statistics::Image native = mean_image(render_or_throw(scene));
    // Kernels are compiled for each scene.
    if (place.name == "SeveralAreaLights" || place.name == "OnPhong")
      EXPECT_EQ(native.values, mean_image(render_or_throw(scene, opencl_device())).values) << place.name;
    EXPECT_EQ(native.values, mean_image(render_or_throw(embree)).values) << place.name;
  }
}

TEST(LitCells, AreOfDirectLightByPolygonsAlone) {
  SceneDescription scene = under_an_area_light();
  scene.shapes.push_back(area_light());
  ASSERT_TRUE(has_lit_cells(scene));
  const auto without = [&](auto change) {
    SceneDescription changed = scene;
    change(changed);
    const DeviceScene built = build_or_throw(changed);
    // Nothing of what they need is left.
    const bool none = (built.header.features & FEATURE_LIT_CELLS) == 0u;
    EXPECT_EQ(none, built.header.tables.lit_faces.count == 0);
    return none && built.header.tables.polygons.count == 0;
  };
  EXPECT_TRUE(without(sample_all));
  EXPECT_TRUE(
      without([](SceneDescription& s) { s.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)}); }));
  EXPECT_TRUE(without([](SceneDescription& s) { s.integrator = path_integrator(DirectSampling::kMis); }));
  EXPECT_TRUE(without([](SceneDescription& s) { s.integrator = with_cells(direct_integrator(0, 1)); }));
}

}  // namespace
}  // namespace penumbra::lit_cells_test
