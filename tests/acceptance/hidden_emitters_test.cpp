// Hidden emitters: the camera sees their surface without emission, or what is behind them; all other rays
// meet them as usual.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::hidden_emitters_test {
namespace {

using glm::dvec3;

constexpr double kSignificance = 0.01;
constexpr double kRounding = 32.0 / (1 << 24);  ///< see furnace_test.cpp
constexpr float kAlbedo = 0.5f, kRadiance = 3;
/// The lights' distance from the floor, and half their side.
constexpr double kHeight = 2, kHalf = 1;

IntegratorSettings hiding(IntegratorSettings integrator, HiddenEmitters how) {
  integrator.hide_emitters = true;
  integrator.hidden_emitters = how;
  return integrator;
}

/// A square that shines down on the floor y = 0 from a height, or with `up` away from it.
Shape area_light(double height, double half, int bsdf, bool up = false) {
  const dvec3 along_x(2 * half, 0, 0), along_z(0, 0, 2 * half);
  return parallelogram({-half, height, -half}, up ? along_z : along_x, up ? along_x : along_z, bsdf,
                       kRadiance);
}

/// One pixel that sees the middle of the floor from above all lights.
SceneDescription floor_from_above(std::uint32_t spp) {
  SceneDescription scene = empty_scene(1, 1, spp, 1);
  scene.camera = look_at(dvec3(0, 9, 0), dvec3(0), dvec3(0, 0, 1), 1e-5);
  scene.shapes.push_back(
      parallelogram({-100, 0, -100}, {0, 0, 200}, {200, 0, 0}, add_diffuse(scene, kAlbedo)));
  return scene;
}

/// What a square of half side a at height h sends to the point below its middle, over pi L: 4 times the view
/// factor from the point below a corner of the rectangle a x a, (2 / 2 pi) (a / r) atan(a / r), r^2 = a^2 +
/// h^2.
double square_above(double h, double a) {
  const double r = std::hypot(a, h);
  return 4 / std::numbers::pi * (a / r) * std::atan(a / r);
}

statistics::Sample pixel(SceneDescription scene, const IntegratorSettings& integrator) {
  scene.integrator = integrator;
  TestDevice device = native_device();
  device.samples_per_pass = kMaxSamplesPerUnit;
  return pixel_sample(render_or_throw(scene, device), 0, 0, 1);
}

void expect_radiance(const SceneDescription& scene, const IntegratorSettings& integrator, double expected) {
  const statistics::Sample sample = pixel(scene, integrator);
  EXPECT_GT(statistics::t_test(sample, expected, expected * kRounding).p, kSignificance)
      << sample.mean() << " +- " << sample.standard_error() << ", expected " << expected;
}

struct Method {
  std::string name;
  IntegratorSettings integrator;
};
void PrintTo(const Method& method, std::ostream* out) { *out << method.name; }

std::vector<Method> methods() {
  IntegratorSettings short_path = path_integrator(DirectSampling::kMis);
  param::max_depth(short_path) = 2;  // going through lights does not add to the depth
  IntegratorSettings analytic, cv;
  use(analytic, IntegratorKind::kPolygonAnalytic);
  use(cv, IntegratorKind::kPolygonCv);
  return {{"PathMis", short_path},
          {"PathEms", path_integrator(DirectSampling::kEmitterOnly)},
          {"PathMats", path_integrator(DirectSampling::kBsdfOnly)},
          {"DirectMis", direct_integrator(1, 1)},
          {"DirectEmitter", direct_integrator(1, 0)},
          {"DirectBsdf", direct_integrator(0, 1)},
          {"PolygonAnalytic", analytic},
          {"PolygonCv", cv}};
}

class HiddenEmitter : public testing::TestWithParam<Method> {};

TEST_P(HiddenEmitter, TheFloorBehindAnAreaLightIsSeenLitByIt) {
  SceneDescription scene = floor_from_above(50'000);
  scene.shapes.push_back(area_light(kHeight, kHalf, kBlackBsdf));
  expect_radiance(scene, hiding(GetParam().integrator, HiddenEmitters::kLookedThrough),
                  kAlbedo * kRadiance * square_above(kHeight, kHalf));
  EXPECT_EQ(pixel(scene, hiding(GetParam().integrator, HiddenEmitters::kUnlit)).mean(), 0);
}

INSTANTIATE_TEST_SUITE_P(Methods, HiddenEmitter, testing::ValuesIn(methods()),
                         [](const auto& tested) { return tested.param.name; });

TEST(HiddenEmitters, AllOfARowAreLookedThroughAndStillCastShadows) {
  // From above: one that shines up, a sphere and a disk that reflect, and the light, which alone lights the
  // floor.
  SceneDescription scene = floor_from_above(50'000);
  const int white = add_diffuse(scene, 1);
  scene.shapes.push_back(area_light(kHeight, kHalf, white));
  scene.shapes.push_back(area_light(3, 2, white, true));
  Shape sphere;
  sphere.geometry = Sphere{{0, 5, 0}, 0.5};
  sphere.radiance = glm::vec3(kRadiance);
  scene.shapes.push_back(sphere);
  Shape disk;
  disk.geometry = Disk{{0, 7, 0}, {0, 1, 0}, 0.4};
  disk.radiance = glm::vec3(kRadiance);
  disk.front_bsdf = disk.back_bsdf = white;
  scene.shapes.push_back(disk);
  // Seen from the middle of the floor the sphere and the disk are behind the light.
  expect_radiance(scene, hiding(direct_integrator(1, 1), HiddenEmitters::kLookedThrough),
                  kAlbedo * kRadiance * square_above(kHeight, kHalf));
}

TEST(HiddenEmitters, TheSkyIsHiddenAndSeenInTheFloor) {
  // The light shades the floor from its share of the sky, and the sky itself is black.
  SceneDescription scene = floor_from_above(50'000);
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
  scene.shapes.push_back(area_light(kHeight, kHalf, kBlackBsdf));
  const double share = square_above(kHeight, kHalf);
  expect_radiance(scene, hiding(direct_integrator(1, 1), HiddenEmitters::kLookedThrough),
                  kAlbedo * (kRadiance * share + (1 - share)));
  scene.shapes.erase(scene.shapes.begin());
  for (const HiddenEmitters how : {HiddenEmitters::kLookedThrough, HiddenEmitters::kUnlit}) {
    EXPECT_EQ(pixel(scene, hiding(direct_integrator(1, 1), how)).mean(), 0);
    EXPECT_EQ(pixel(scene, hiding(path_integrator(DirectSampling::kMis), how)).mean(), 0);
  }
}

/// No ray meets an unseen light, neither the camera's nor those of surfaces, which find it by samples alone.
TEST(UnseenEmitters, LightTheFloorByThemselves) {
  for (const Method& method : methods()) {
    if (method.name == "DirectBsdf" || method.name.starts_with("Polygon")) continue;
    SCOPED_TRACE(method.name);
    SceneDescription scene = floor_from_above(50'000);
    scene.bsdfs.push_back({"nothing", NullBsdf{}});
    const int nothing = int(scene.bsdfs.size()) - 1;
    scene.shapes.push_back(area_light(kHeight, kHalf, nothing));
    scene.shapes.back().back_bsdf = nothing;
    scene.shapes.back().unseen_emission = true;
    const double square = square_above(kHeight, kHalf);
    expect_radiance(scene, method.integrator, kAlbedo * kRadiance * square);
    // A sphere above: its sine squared.
    scene.shapes.pop_back();
    Shape sphere;
    sphere.geometry = Sphere{{0, 5, 0}, 0.5};
    sphere.front_bsdf = sphere.back_bsdf = nothing;
    sphere.radiance = glm::vec3(kRadiance);
    sphere.unseen_emission = true;
    scene.shapes.push_back(sphere);
    expect_radiance(scene, method.integrator, kAlbedo * kRadiance * 0.01);
  }
}

TEST(HiddenEmitters, LayersAndClippingPlanesAreThoseOfWhatIsSeen) {
  SceneDescription scene = floor_from_above(4);
  scene.shapes.push_back(area_light(kHeight, kHalf, kBlackBsdf));
  scene.shapes.push_back(area_light(4, kHalf, kBlackBsdf, true));
  scene.integrator = hiding(direct_integrator(1, 1), HiddenEmitters::kLookedThrough);
  const FilmAccumulator film = render_or_throw(scene);
  EXPECT_FLOAT_EQ(float(film.layer(0, 0, LAYER_DEPTH)), float(9 - scene.camera.near_clip));
  EXPECT_FLOAT_EQ(float(film.layer(0, 0, LAYER_NORMAL, 1)), 1);
  scene.camera.far_clip = 8.9;
  EXPECT_EQ(render_or_throw(scene).layer(0, 0, LAYER_DEPTH), 0);
  scene.camera.far_clip = 9.1;
  EXPECT_GT(render_or_throw(scene).layer(0, 0, LAYER_DEPTH), 0);
}

/// One above the other and in one place, tested whole and by the hierarchy.
TEST(HiddenEmitters, ManyAtOnce) {
  for (const int count : {40, 1500}) {
    SceneDescription scene = floor_from_above(1);
    for (int i = 0; i < count; ++i) scene.shapes.push_back(area_light(kHeight + i * 1e-3, kHalf, kBlackBsdf));
    scene.integrator = hiding(direct_integrator(1, 0), HiddenEmitters::kLookedThrough);
    EXPECT_GT(render_or_throw(scene).layer(0, 0, LAYER_DEPTH), 8) << count;
    for (Shape& shape : scene.shapes) {
      if (!shape.radiance) continue;
      for (dvec3& p : std::get<Mesh>(shape.geometry).positions) p.y = kHeight;
    }
    EXPECT_GT(render_or_throw(scene).layer(0, 0, LAYER_DEPTH), 8) << count << " in one place";
  }
}

}  // namespace
}  // namespace penumbra::hidden_emitters_test
