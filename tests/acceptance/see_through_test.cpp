// Masks, blends and null surfaces: camera rays, path rays and shadow rays pass them alike, so every strategy
// finds the transmitted light of the closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/strategies.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

using glm::dvec3;

constexpr double kSignificance = 0.01;
constexpr double kRounding = 64.0 / (1 << 24);  ///< see furnace_test.cpp; twice as many surfaces on the way
constexpr float kAlbedo = 0.5f, kRadiance = 3;
constexpr double kHeight = 2, kHalf = 1;  ///< of the light, and half its side

int add(SceneDescription& scene, BsdfModel model) {
  scene.bsdfs.push_back({"test", std::move(model)});
  return int(scene.bsdfs.size()) - 1;
}
int add_null(SceneDescription& scene) { return add(scene, NullBsdf{}); }
int add_mask(SceneDescription& scene, float opacity, int inside) {
  return add(scene, MaskBsdf{opacity, inside});
}

Shape two_sided(Shape shape) {
  shape.back_bsdf = shape.front_bsdf;
  return shape;
}

/// A square parallel to the floor y = 0, larger than all else.
Shape sheet(double height, int bsdf) {
  return two_sided(parallelogram({-50, height, -50}, {0, 0, 100}, {100, 0, 0}, bsdf));
}

/// What shines down on the floor.
Shape area_light(int bsdf = kBlackBsdf) {
  return parallelogram({-kHalf, kHeight, -kHalf}, {2 * kHalf, 0, 0}, {0, 0, 2 * kHalf}, bsdf, kRadiance);
}

/// What a square of half side a at height h sends to the point below its middle, over pi L: see
/// hidden_emitters_test.cpp.
double square_above(double h, double a) {
  const double r = std::hypot(a, h);
  return 4 / std::numbers::pi * (a / r) * std::atan(a / r);
}

/// One pixel that sees the middle of the floor from between it and the light.
SceneDescription floor_below_area_light(std::uint32_t spp) {
  SceneDescription scene = empty_scene(1, 1, spp, 1);
  scene.camera = look_at(dvec3(0, 1, 0), dvec3(0), dvec3(0, 0, 1), 1e-5);
  scene.shapes.push_back(
      parallelogram({-100, 0, -100}, {0, 0, 200}, {200, 0, 0}, add_diffuse(scene, kAlbedo)));
  return scene;
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

std::vector<Strategy> strategies() {
  std::vector<Strategy> all = all_strategies();
  IntegratorSettings cv, path_cv = path_integrator(DirectSampling::kMis);
  use(cv, IntegratorKind::kPolygonCv);
  param::next_event(path_cv) = NextEvent::kCv;
  all.push_back({"PolygonCv", cv});
  all.push_back({"PathCv", path_cv});
  IntegratorSettings whitted = path_cv;
  use(whitted, IntegratorKind::kWhitted);
  param::indirect_samples(whitted) = 3;
  all.push_back({"WhittedCv", whitted});
  param::next_event(whitted) = NextEvent::kSample;
  all.push_back({"Whitted", whitted});
  return all;
}

class SeeThrough : public testing::TestWithParam<Strategy> {};

TEST_P(SeeThrough, LayersLetThroughWhatTheirMasksLeave) {
  SceneDescription scene = floor_below_area_light(40'000);
  scene.shapes.push_back(area_light());
  const int white = kBlackBsdf;
  double lit = 1, seen = 1;
  const auto layer = [&](double height, int bsdf, double share) {
    scene.shapes.push_back(sheet(height, bsdf));
    lit *= share;
    if (height < 1) seen *= share;
  };
  layer(0.3, add_mask(scene, 0.2f, white), 0.8);
  layer(0.6, add_mask(scene, 0.5f, add_mask(scene, 0.5f, white)), 0.75);  // one in another
  const int thin = add_mask(scene, 0.25f, white), thick = add_mask(scene, 0.75f, white);
  layer(1.3, add(scene, BlendBsdf{0.25f, thin, thick}),
        0.75 * 0.75 + 0.25 * 0.25);  // a choice in shadow rays
  layer(1.6, add(scene, BlendBsdf{0.9f, white, kNoBsdf}), 0.9);
  layer(1.7, add_null(scene), 1);
  layer(1.8, add_mask(scene, 0, white), 1);
  const double expected = kAlbedo * kRadiance * square_above(kHeight, kHalf) * lit * seen;
  expect_radiance(scene, GetParam().integrator, expected);
}

TEST_P(SeeThrough, NullSurfacesOfLightsShineAndDoNotBlock) {
  // From above: the light, a ball that shines and a disk that does, both of nothing. The light of each is the
  // same as without the others.
  SceneDescription scene = floor_below_area_light(40'000);
  const int nothing = add_null(scene);
  scene.shapes.push_back(area_light());
  Shape ball, disk;
  ball.geometry = Sphere{{0, 1.5, 0}, 0.25};
  disk.geometry = Disk{{0, 1.1, 0}, {0, -1, 0}, 0.2};
  for (Shape* shape : {&ball, &disk}) {
    shape->front_bsdf = shape->back_bsdf = nothing;
    shape->radiance = glm::vec3(2);
    scene.shapes.push_back(*shape);
  }
  const double by_ball = 2 * (0.25 * 0.25) / (1.5 * 1.5), by_disk = 2 * (0.2 * 0.2) / (1.1 * 1.1 + 0.2 * 0.2);
  const double lit = kAlbedo * (kRadiance * square_above(kHeight, kHalf) + by_ball + by_disk);
  expect_radiance(scene, GetParam().integrator, lit);
  // Seen from above through the ball, whose light adds to the floor's, and the disk, which faces away.
  scene.camera = look_at(dvec3(0, 1.9, 0), dvec3(0), dvec3(0, 0, 1), 1e-5);
  expect_radiance(scene, GetParam().integrator, lit + 2);
}

TEST_P(SeeThrough, ABlendIsTheWeighedSumOfBoth) {
  SceneDescription scene = floor_below_area_light(40'000);
  scene.shapes.push_back(area_light());
  const int dark = add_diffuse(scene, 0.1f), bright = add_diffuse(scene, 0.9f);
  scene.shapes[0].front_bsdf = add(scene, BlendBsdf{0.3f, dark, bright});
  expect_radiance(scene, GetParam().integrator,
                  (0.7 * 0.1 + 0.3 * 0.9) * kRadiance * square_above(kHeight, kHalf));
}

INSTANTIATE_TEST_SUITE_P(Strategies, SeeThrough, testing::ValuesIn(strategies()),
                         strategy_name<testing::TestParamInfo<Strategy>>);

TEST(SeeThroughTest, BlendsChooseByTheWeightOfTheFace) {
  // Each sample sees one of the two: its variance is that of the choice. Mitsuba 3 sees both at once, so that
  // the variances of its reference images are too small for blends (mesh_attributes_1_face).
  constexpr double kDark = 0.1, kBright = 0.9, kIntensity = 2;
  SceneDescription scene = empty_scene(1, 1, 40'000, 1);
  scene.textures.push_back({"weights", MeshAttributeTexture{MeshAttribute::kFaceColour}});
  BlendBsdf blend;
  blend.weight.texture = 0;
  blend.first = add_diffuse(scene, float(kDark)), blend.second = add_diffuse(scene, float(kBright));
  Shape floor = parallelogram({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, add(scene, blend));
  Mesh& mesh = std::get<Mesh>(floor.geometry);
  mesh.face_colours = {glm::vec3(0.2f), glm::vec3(0.7f)};
  scene.shapes.push_back(floor);
  for (std::size_t face = 0; face < 2; ++face) {
    const glm::uvec3& t = mesh.triangles.at(face);
    const dvec3 middle = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0;
    scene.camera = look_at(middle + dvec3(0, 2, 0), middle, dvec3(0, 0, 1), 1e-5);
    scene.emitters = {PointLight{middle + dvec3(0, 1, 0), glm::vec3(kIntensity)}};
    const statistics::Sample sample = pixel_sample(render_or_throw(scene), 0, 0, 0);
    const double w = double(mesh.face_colours[face].x), choice = w * (1 - w),
                 step = kIntensity / std::numbers::pi * (kBright - kDark), n = double(sample.count());
    EXPECT_NEAR(sample.mean(), kIntensity / std::numbers::pi * kDark + w * step,
                4 * std::sqrt(choice / n) * step);
    // The fourth moment of a choice is w (1 - w) (1 - 3 w (1 - w)).
    EXPECT_NEAR(sample.variance() / (step * step), choice,
                4 * std::sqrt(choice * (1 - 4 * choice) / n) + kRounding);
  }
}

TEST(SeeThroughTest, NothingIsLostAmongWhiteMasks) {
  // Balls of half a white surface around the camera, in a sky of radiance 1: that is seen everywhere.
  SceneDescription scene = empty_scene(1, 1, 20'000, 3);
  scene.camera = look_at(dvec3(0.3, 0, 0), dvec3(1, 0.2, 0), dvec3(0, 1, 0), 60);
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
  const int mask = add_mask(scene, 0.5f, add_diffuse(scene, 1));
  for (int k = 1; k <= 5; ++k) {
    Shape ball;
    ball.geometry = Sphere{{0, 0, 0}, double(k)};
    ball.front_bsdf = ball.back_bsdf = mask;
    scene.shapes.push_back(ball);
  }
  for (const DirectSampling sampling :
       {DirectSampling::kMis, DirectSampling::kBsdfOnly, DirectSampling::kEmitterOnly}) {
    IntegratorSettings integrator = path_integrator(sampling);
    param::rr_depth(integrator) = 1000;
    expect_radiance(scene, integrator, 1);
  }
}

TEST(SeeThroughTest, PassedSurfacesAreNoDepth) {
  SceneDescription scene = floor_below_area_light(20'000);
  scene.shapes.push_back(area_light());
  for (int k = 1; k < 10; ++k) scene.shapes.push_back(sheet(0.1 * k, add_null(scene)));
  IntegratorSettings integrator = path_integrator(DirectSampling::kMis);
  param::max_depth(integrator) = 2;
  param::rr_depth(integrator) = 1;
  expect_radiance(scene, integrator, kAlbedo * kRadiance * square_above(kHeight, kHalf));
}

TEST(SeeThroughTest, TexturesAreOpacities) {
  SceneDescription scene = empty_scene(2, 2, 4, 1);
  scene.camera = look_at(dvec3(0, 0, 0), dvec3(0, 0, 1), dvec3(0, 1, 0), 90);
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
  CheckerboardTexture board;
  board.color0 = glm::vec3(1);
  board.color1 = glm::vec3(0);
  scene.textures.push_back({"board", board});
  MaskBsdf mask{1.0f, kBlackBsdf};
  mask.opacity.texture = 0;
  Shape wall = parallelogram({-1, -1, 1}, {0, 2, 0}, {2, 0, 0}, add(scene, mask));
  std::get<Mesh>(wall.geometry).texcoords = {{0, 0}, {0, 1}, {1, 1}, {0, 0}, {1, 1}, {1, 0}};
  scene.shapes.push_back(two_sided(wall));
  for (const DirectSampling sampling : {DirectSampling::kMis, DirectSampling::kBsdfOnly}) {
    scene.integrator = path_integrator(sampling);
    const FilmAccumulator film = render_or_throw(scene);
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x) EXPECT_EQ(film.at(x, y).mean[0], x == y ? 0 : 1) << x << ' ' << y;
  }
  // Values beyond [0, 1] count as the nearest within.
  board.color0 = glm::vec3(7);
  scene.textures[0].model = board;
  EXPECT_EQ(render_or_throw(scene).at(0, 0).mean[0], 0);
  EXPECT_EQ(render_or_throw(scene).at(0, 1).mean[0], 1);
}

TEST(SeeThroughTest, LayersAreOfWhatIsSeenBehind) {
  SceneDescription scene = floor_below_area_light(1);
  scene.shapes.push_back(area_light());
  const FilmAccumulator without = render_or_throw(scene);
  for (int k = 1; k < 9; ++k) scene.shapes.push_back(sheet(0.1 * k, add_null(scene)));
  Shape ball;
  ball.geometry = Sphere{{0, 1, 0}, 0.15};
  ball.front_bsdf = ball.back_bsdf = add_mask(scene, 0, add_diffuse(scene, 1));
  scene.shapes.push_back(ball);
  const FilmAccumulator film = render_or_throw(scene);
  EXPECT_NEAR(film.layer(0, 0, LAYER_DEPTH), without.layer(0, 0, LAYER_DEPTH), 1e-6);
  EXPECT_NEAR(film.layer(0, 0, LAYER_NORMAL, 1), without.layer(0, 0, LAYER_NORMAL, 1), 1e-6);
  scene.camera.far_clip = 0.9;
  EXPECT_EQ(render_or_throw(scene).layer(0, 0, LAYER_DEPTH), 0);
}

/// Tested whole and by the hierarchy, ours and Embree's.
TEST(SeeThroughTest, ManyInARowAndInOnePlace) {
  for (const int count : {20, 1500}) {
    for (const bool embree : {false, true}) {
      SceneDescription scene = floor_below_area_light(1);
      const int nothing = add_null(scene);
      for (int i = 0; i < count; ++i) scene.shapes.push_back(sheet(0.1 + i * 0.8 / count, nothing));
      scene.emitters.emplace_back(PointLight{.position = {0, 2, 0}, .intensity = glm::vec3(4)});
      scene.integrator = direct_integrator(1, 0);
      TestDevice device = native_device();
      device.embree = embree;
      EXPECT_NEAR(render_or_throw(scene, device).at(0, 0).mean[0], kAlbedo / std::numbers::pi, 1e-5) << count;
      for (Shape& shape : scene.shapes)
        if (shape.front_bsdf == nothing)
          for (dvec3& p : std::get<Mesh>(shape.geometry).positions) p.y = 0.5;
      EXPECT_NEAR(render_or_throw(scene, device).at(0, 0).mean[0], kAlbedo / std::numbers::pi, 1e-5)
          << count << " in one place";
    }
  }
}

TEST(SeeThroughTest, HiddenAreaLightsAndMasksTogether) {
  SceneDescription scene = floor_below_area_light(40'000);
  scene.camera = look_at(dvec3(0, 9, 0), dvec3(0), dvec3(0, 0, 1), 1e-5);
  scene.shapes.push_back(area_light(add_diffuse(scene, 1)));
  scene.shapes.push_back(sheet(5, add_mask(scene, 0.25f, kBlackBsdf)));
  scene.shapes.push_back(sheet(1, add_mask(scene, 0.5f, kBlackBsdf)));
  for (IntegratorSettings integrator : {path_integrator(DirectSampling::kMis), direct_integrator(1, 1)}) {
    integrator.hide_emitters = true;
    integrator.hidden_emitters = HiddenEmitters::kLookedThrough;
    expect_radiance(scene, integrator,
                    kAlbedo * kRadiance * square_above(kHeight, kHalf) * 0.5 * (0.75 * 0.5));
  }
}

}  // namespace
}  // namespace penumbra
