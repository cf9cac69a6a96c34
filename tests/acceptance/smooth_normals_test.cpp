// Meshes with vertex normals. The geometric normal decides which side of a triangle is seen and which side
// receives light: silhouettes are not black, no light leaks through sheets or into closed rooms, and all
// strategies integrate the same function.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/acceptance/shadowed_polygon.h"
#include "tests/acceptance/strategies.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::smooth_normals_test {
namespace {

using glm::dvec3;

constexpr double kSignificance = 0.01;
constexpr double kRounding = 64.0 / (1 << 24);  ///< relative; see furnace_test.cpp
constexpr double kQuadrature = 1e-4;            ///< relative: the light's part above the floor by cells
constexpr int kPixels = 32;

/// The coarsest of smooth spheres: its normals lean up to 37 degrees away from its triangles'.
Shape icosahedron(const dvec3& center, double radius) {
  const double a = radius / std::hypot(1, std::numbers::phi), b = a * std::numbers::phi;
  Mesh mesh;
  mesh.positions = {{-a, b, 0},  {a, b, 0},  {-a, -b, 0}, {a, -b, 0}, {0, -a, b},  {0, a, b},
                    {0, -a, -b}, {0, a, -b}, {b, 0, -a},  {b, 0, a},  {-b, 0, -a}, {-b, 0, a}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (dvec3& p : mesh.positions) {
    mesh.normals.push_back(glm::vec3(glm::normalize(p)));
    p += center;
  }
  Shape shape;
  shape.name = "icosahedron";
  shape.geometry = std::move(mesh);
  return shape;
}

const dvec3 kLean = glm::normalize(dvec3(0.9, 1, 0.3));
/// A square of the floor y = 0 whose vertex normals lean over, which the camera sees from above.
SceneDescription leaning_floor(const BsdfModel& bsdf, const dvec3& viewer, std::uint32_t seed) {
  SceneDescription scene = receiver_scene(bsdf, viewer, kPixels, seed);
  Mesh& mesh = std::get<Mesh>(scene.shapes[0].geometry);
  mesh.normals.assign(mesh.positions.size(), glm::vec3(kLean));
  return scene;
}

TEST(SmoothNormals, RimsShowTheOutsideAsBrightAsTheRest) {
  for (const bool two_sided : {false, true})
    for (const Strategy& strategy : all_strategies()) {
      SceneDescription scene = empty_scene(kPixels, kPixels, 64, 3);
      scene.camera = look_at(dvec3(0, 0, 4), dvec3(0.02, 0.03, 0), dvec3(0, 1, 0), 30);
      scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
      scene.bsdfs.push_back({"outside", DiffuseBsdf{glm::vec3(0.8f)}});
      scene.bsdfs.push_back({"inside", DiffuseBsdf{glm::vec3(0.8f, 0, 0)}});
      scene.shapes.push_back(icosahedron(dvec3(0), 1));
      scene.shapes[0].front_bsdf = 0;
      scene.shapes[0].back_bsdf = two_sided ? 1 : kBlackBsdf;
      scene.integrator = strategy.integrator;
      scene.integrator.hide_emitters = true;
      const FilmAccumulator film = render_or_throw(scene);
      // Where the whole pixel is on the mesh, what is beneath its triangles takes at most a tenth.
      const double least = 0.8 * 0.5 * (1 + std::cos(37.4 / 180 * std::numbers::pi));
      for (int y = 0; y < kPixels; ++y)
        for (int x = 0; x < kPixels; ++x) {
          const PixelStatistics& pixel = film.at(x, y);
          ASSERT_NEAR(pixel.mean[0], pixel.mean[1], 1e-6) << strategy.name << " " << x << ", " << y;
          if (film.layer(x, y, LAYER_ALBEDO, 1) < 0.7999) continue;  // it sees the sky too
          const double error = std::sqrt(pixel.m2[1]) / double(pixel.count);
          ASSERT_GE(pixel.mean[1], least - 5 * error) << strategy.name << " " << x << ", " << y;
        }
    }
}

/// In front of a white sky, what absorbs nothing is white too, although a tenth of the mirrored directions
/// are beneath the triangles.
TEST(SmoothNormals, ThinGlassLosesNoLight) {
  SceneDescription scene = empty_scene(kPixels, kPixels, 16, 3);
  scene.camera = look_at(dvec3(0, 0, 4), dvec3(0.02, 0.03, 0), dvec3(0, 1, 0), 30);
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
  scene.bsdfs.push_back({"glass", ThinDielectricBsdf{}});
  scene.shapes.push_back(icosahedron(dvec3(0), 1));
  scene.shapes[0].front_bsdf = scene.shapes[0].back_bsdf = 0;
  scene.integrator = path_integrator(DirectSampling::kMis);
  param::max_depth(scene.integrator) = 1000;
  param::rr_depth(scene.integrator) = 1000;
  ASSERT_NE(build_or_throw(scene).header.features & FEATURE_PANES, 0u);
  const FilmAccumulator film = render_or_throw(scene);
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x) ASSERT_NEAR(film.at(x, y).mean[1], 1, kRounding) << x << ", " << y;
}

/// Exactly, since nothing may be seen there.
void expect_black(SceneDescription scene, const std::string& what) {
  for (const Strategy& strategy : all_strategies()) {
    scene.integrator = strategy.integrator;
    const FilmAccumulator film = render_or_throw(scene);
    for (int y = 0; y < film.height(); ++y)
      for (int x = 0; x < film.width(); ++x)
        ASSERT_EQ(film.at(x, y).mean[1], 0) << what << " by " << strategy.name << ": " << x << ", " << y;
  }
}

void add_lights_beyond(SceneDescription& scene, bool sky) {
  if (sky) scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
  scene.emitters.emplace_back(PointLight{dvec3(3, -2.5, 1), glm::vec3(10)});
  scene.shapes.push_back(parallelogram(dvec3(-3, -4, -3), dvec3(0, 0, 6), dvec3(6, 0, 0), kBlackBsdf, 5.0f));
  scene.shapes.back().two_sided_emission = true;
  Shape sphere;
  sphere.name = "sphere";
  sphere.geometry = Sphere{dvec3(4, -3, 0), 0.8};
  sphere.radiance = glm::vec3(1);
  scene.shapes.push_back(sphere);
}

/// But for a path in some 10^7, whatever the strategy, see "Intersection" of kernels/README.md; with this
/// seed there is none.
TEST(SmoothNormals, NoLightGetsIntoAClosedRoom) {
  SceneDescription scene = empty_scene(kPixels, kPixels, 64, 1);
  scene.camera = look_at(dvec3(0.1, 0.2, -0.5), dvec3(0.1, -0.2, 1), dvec3(0, 1, 0), 90);
  scene.shapes.push_back(icosahedron(dvec3(0), 1));
  scene.shapes[0].front_bsdf = scene.shapes[0].back_bsdf = add_diffuse(scene, 0.8f);
  add_lights_beyond(scene, true);
  expect_black(scene, "room");
}

TEST(SmoothNormals, NoLightGetsThroughASheet) {
  for (const BsdfModel& bsdf :
       {BsdfModel(DiffuseBsdf{glm::vec3(0.8f)}), BsdfModel(PhongBsdf{glm::vec3(0.3f), glm::vec3(0.5f), 5})}) {
    SceneDescription scene = leaning_floor(bsdf, dvec3(-0.3, 1, 0.2), 6);
    scene.shapes[0].back_bsdf = scene.shapes[0].front_bsdf;
    add_lights_beyond(scene, false);
    expect_black(scene, "sheet");
  }
}

struct Leaning {
  std::string name;
  BsdfModel bsdf;
  dvec3 viewer;
};
void PrintTo(const Leaning& tested, std::ostream* out) { *out << tested.name; }

class LeaningNormals : public testing::TestWithParam<Leaning> {};

const dvec3 kLightCorner(2.2, -0.8, -1.2), kLightU(0.3, 1.6, 0), kLightV(-0.4, 0, 2.1);
/// A light that goes through the floor's plane.
Shape light_through_floor() {
  Shape light =
      parallelogram(dvec3(2.2, -0.8, -1.2), dvec3(0.3, 1.6, 0), dvec3(-0.4, 0, 2.1), kBlackBsdf, 2.0f);
  light.two_sided_emission = true;
  return light;
}

statistics::Sample rendered(SceneDescription scene, const IntegratorSettings& integrator, std::uint32_t seed,
                            std::uint32_t spp = 64) {
  scene.integrator = integrator;
  scene.sampler.spp = spp;
  scene.sampler.seed = seed;
  TestDevice device = native_device();
  device.samples_per_pass = spp;
  const FilmAccumulator film = render_or_throw(scene, device);
  statistics::Sample means;  // of the pixels, which are independent: samples of one may share an alpha
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x) means.add(film.at(x, y).mean[1]);
  return means;
}

std::vector<Strategy> methods_for_polygons() {
  std::vector<Strategy> all = all_strategies();
  for (Strategy& strategy : all) limit_depth(strategy.integrator, 2);
  for (const EmitterSampling sampling :
       {EmitterSampling::kArea, EmitterSampling::kSolidAngle, EmitterSampling::kProjected}) {
    const std::string how = " by sampling " + std::to_string(int(sampling));
    all.push_back({"polygon_cv, alpha 1" + how, polygon_cv(1.0f, sampling, 2)});
    all.push_back({"polygon_cv, alpha 0.4" + how, polygon_cv(0.4f, sampling, 1)});
    all.push_back({"polygon_cv, alpha auto" + how, polygon_cv(std::nullopt, sampling, 1)});
    IntegratorSettings area = emitter_only(sampling, 2);
    use(area, IntegratorKind::kPolygonArea);
    all.push_back({"polygon_area" + how, area});
    IntegratorSettings path = path_integrator(DirectSampling::kMis);
    param::max_depth(path) = 2;
    param::emitter_sampling(path) = sampling;
    param::next_event(path) = NextEvent::kCv;
    param::alpha(path) = 1.0f;
    all.push_back({"path with control variates" + how, path});
  }
  return all;
}

/// What the floor's origin reflects of that light's part above the floor, by midpoints in double.
double reflected_of_light(const Leaning& tested) {
  const dvec3 wo = glm::normalize(tested.viewer), up(0, 1, 0);
  const dvec3 n = glm::dot(kLean, wo) > 0 ? kLean : up, mirror = 2 * glm::dot(n, wo) * n - wo;
  const dvec3 area = glm::cross(kLightU, kLightV);
  constexpr int kNodes = 3000;
  double sum = 0;
  for (int i = 0; i < kNodes; ++i)
    for (int j = 0; j < kNodes; ++j) {
      const dvec3 p = kLightCorner + (i + 0.5) / kNodes * kLightU + (j + 0.5) / kNodes * kLightV;
      const double d2 = glm::dot(p, p);
      const dvec3 wi = p / std::sqrt(d2);
      if (wi.y <= 0 || glm::dot(n, wi) <= 0) continue;
      double f = 0;
      if (const auto* diffuse = std::get_if<DiffuseBsdf>(&tested.bsdf)) {
        f = diffuse->reflectance.value.y / std::numbers::pi;
      } else {
        const PhongBsdf& phong = std::get<PhongBsdf>(tested.bsdf);
        const double lobe = std::pow(std::max(glm::dot(wi, mirror), 0.0), double(phong.exponent.value));
        f = (phong.diffuse.value.y + phong.specular.value.y * (phong.exponent.value + 2) / 2 * lobe) /
            std::numbers::pi;
      }
      sum += f * glm::dot(n, wi) * std::abs(glm::dot(area, wi)) / d2;
    }
  return 2 * sum / (double(kNodes) * kNodes);
}

TEST_P(LeaningNormals, StrategiesAgreeOnALightThatIsPartlyBeneath) {
  SceneDescription scene = leaning_floor(GetParam().bsdf, GetParam().viewer, 1);
  scene.shapes.push_back(light_through_floor());
  const double expected = reflected_of_light(GetParam());
  ManyTests tests;
  std::uint32_t seed = 1;
  for (const Strategy& strategy : methods_for_polygons())
    tests.add(
        statistics::t_test(rendered(scene, strategy.integrator, seed++), expected, kQuadrature * expected),
        strategy.name);
  tests.expect_passed(kSignificance);
}

TEST_P(LeaningNormals, TheClosedFormIsTheMeanWithoutShadows) {
  SceneDescription scene = leaning_floor(GetParam().bsdf, GetParam().viewer, 1);
  scene.shapes.push_back(light_through_floor());
  IntegratorSettings analytic;
  use(analytic, IntegratorKind::kPolygonAnalytic);
  const double closed = rendered(scene, analytic, 1).mean();
  ManyTests tests;
  for (const EmitterSampling sampling :
       {EmitterSampling::kArea, EmitterSampling::kSolidAngle, EmitterSampling::kProjected}) {
    IntegratorSettings area = emitter_only(sampling, 2);
    use(area, IntegratorKind::kPolygonArea);
    param::trace_shadows(area) = false;
    tests.add(
        statistics::t_test(rendered(scene, area, 7 + std::uint32_t(sampling)), closed, kRounding * closed),
        std::to_string(int(sampling)));
  }
  tests.expect_passed(kSignificance);
}

// The last is seen from where its normals face away, and its triangles' own take over.
INSTANTIATE_TEST_SUITE_P(
    Floors, LeaningNormals,
    testing::Values(Leaning{"Diffuse", DiffuseBsdf{glm::vec3(0.8f)}, dvec3(0.6, 1.1, -0.4)},
                    Leaning{"Glossy", PhongBsdf{glm::vec3(0.3f), glm::vec3(0.5f), 12}, dvec3(0.6, 1.1, -0.4)},
                    Leaning{"DiffuseFacingAway", DiffuseBsdf{glm::vec3(0.8f)}, dvec3(-1.5, 0.4, -0.2)},
                    Leaning{"GlossyFacingAway", PhongBsdf{glm::vec3(0.3f), glm::vec3(0.5f), 12},
                            dvec3(-1.5, 0.4, -0.2)}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace penumbra::smooth_normals_test
