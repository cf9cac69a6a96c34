// The objects and materials (Cryptomatte) that a pixel's samples hit first.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "scenes/device/device_scene_builder.h"
#include "scenes/matte_names.h"
#include "scenes/transform.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::mattes_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kWidth = 32;
constexpr double kEdge = 0.37, kDepth = 6;
constexpr std::uint32_t kSamples = 1024;

/// A scene with who is in it.
struct OwnedScene {
  DeviceScene device;
  MatteNames names;
};

OwnedScene owned(const SceneDescription& scene, bool embree = false) {
  OwnedScene built;
  DeviceSceneOptions options;
  options.intersector = embree ? IntersectorChoice::kEmbree : IntersectorChoice::kPortable;
  options.mattes = &built.names;
  auto device = build_device_scene(scene, options);
  if (!device) throw std::runtime_error(device.error().message);
  built.device = std::move(*device);
  return built;
}

/// Shares of a pixel's samples, by the objects' names.
std::map<std::string, double> shares(const OwnedScene& scene, const FilmAccumulator& film, int x, int y = 0) {
  std::map<std::string, double> result;
  for (const MatteWeight& each : film.mattes(x, y))
    result[scene.names.objects[scene.names.mattes[std::size_t(each.matte) - 1].object]] +=
        each.weight / double(film.at(x, y).count);
  return result;
}

Shape named(Shape shape, const char* name) {
  shape.name = name;
  return shape;
}

/// A camera at the origin that looks along z, x to the left. The half x > kEdge of its world is "left", what
/// is behind the rest of the upper half "right", and below that is nothing.
SceneDescription two_planes() {
  SceneDescription scene = empty_scene(kWidth, 2, kSamples, 5);
  scene.integrator = direct_integrator(1, 0);
  add_diffuse(scene, 0.5f);
  scene.bsdfs[0].name = "grey";
  scene.shapes.push_back(named(parallelogram({kEdge, -1e3, kDepth}, {0, 2e3, 0}, {1e3, 0, 0}, 0, 1), "left"));
  scene.shapes.push_back(
      named(parallelogram({-1e3, 0, 2 * kDepth}, {0, 1e3, 0}, {2e3, 0, 0}, kBlackBsdf), "right"));
  scene.camera = {};
  scene.camera.fov = 60;
  return scene;
}

double edge() { return 0.5 * kWidth * (1 - kEdge / kDepth / std::tan(std::numbers::pi / 6)); }
double covered(int x) { return std::clamp(edge() - x, 0.0, 1.0); }
/// Five standard deviations of a share of the samples, and the rounding of a ray; what is whole is exact.
double tolerance(double share) {
  return share == 0 || share == 1 ? 0 : 5 * std::sqrt(share * (1 - share) / kSamples) + 1e-4;
}

void expect_two_planes(const SceneDescription& description) {
  const OwnedScene scene = owned(description);
  const FilmAccumulator film = render_or_throw(scene.device);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < kWidth; ++x) {
      auto there = shares(scene, film, x, y);
      const double left = covered(x), right = y == 0 ? 1 - left : 0;
      EXPECT_NEAR(there["left"], left, tolerance(left)) << x << ',' << y;
      EXPECT_NEAR(there["right"], right, tolerance(right)) << x << ',' << y;
      if (y == 0) EXPECT_EQ(there["left"] + there["right"], 1.0) << "nothing is lost";
    }
}

TEST(Mattes, CoverTheShareOfThePixelWhateverTheIntegrator) {
  SceneDescription scene = two_planes();
  expect_two_planes(scene);
  for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kWhitted,
                                    IntegratorKind::kPolygonCv, IntegratorKind::kAmbientOcclusion}) {
    SCOPED_TRACE(int(kind));
    use(scene.integrator, kind);
    expect_two_planes(scene);
  }
}

TEST(Mattes, AreNamedByTheSceneOrInAFixedWay) {
  SceneDescription scene = two_planes();
  Shape sphere;
  sphere.geometry = Sphere{{0, 0, 3}, 0.2};
  sphere.name = "sphere at scenes/room.xml:12:3";
  sphere.front_bsdf = sphere.back_bsdf = 0;
  sphere.material = "gold";
  scene.shapes.push_back(sphere);
  scene.shapes.push_back(named(scene.shapes[1], "right"));
  scene.bsdfs.push_back({"diffuse at scenes/room.xml:9:3", DiffuseBsdf{}});
  scene.shapes.back().front_bsdf = 1;
  scene.shapes.back().back_bsdf = 0;  // its front names it
  const MatteNames names = owned(scene).names;
  EXPECT_THAT(names.objects, ElementsAre("left", "right", "shape-3"));
  EXPECT_THAT(names.materials, ElementsAre("grey", "black", "gold", "material-2"));
  EXPECT_THAT(names.mattes, ElementsAre(MatteNames::Matte{0, 0}, MatteNames::Matte{1, 1},
                                        MatteNames::Matte{2, 2}, MatteNames::Matte{1, 3}));
}

/// Three spheres in a row, placed by instances of one group, which also has a light; and a sphere by itself.
SceneDescription instances(bool area_light) {
  SceneDescription scene = empty_scene(48, 16, 16, 3);
  scene.integrator = path_integrator(DirectSampling::kMis);
  add_diffuse(scene, 0.5f);
  ShapeGroup group;
  group.name = "shapegroup at a.xml:1:1";
  Shape ball;
  ball.name = "ball";
  ball.geometry = Sphere{{0, 0, 0}, 0.4};
  ball.front_bsdf = ball.back_bsdf = 0;
  ball.material = "clay";
  Shape square = parallelogram({-0.3, 0.3, -0.6}, {0.6, 0, 0}, {0, 0.3, 0}, 0);
  square.name = "square";
  square.material = "paper";
  group.shapes = {ball, square};
  if (area_light) {
    group.shapes.push_back(ball);
    group.shapes.back().geometry = Sphere{{0, -0.5, 0}, 0.15};
    group.shapes.back().radiance = glm::vec3(1);
    group.shapes.back().material = "area_light";
  }
  scene.groups.push_back(group);
  const char* names[] = {"first", "instance at a.xml:2:1", "third"};
  for (int i = 0; i < 3; ++i)
    scene.instances.push_back({names[i], 0, translation(glm::dvec3(1.2 * (i - 1), 0, 5))});
  ball.geometry = Sphere{{0, 1, 6}, 0.3};
  scene.shapes.push_back(ball);
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
  scene.camera = {};
  scene.camera.fov = 50;
  return scene;
}

/// How many pixels' samples met each, by name.
std::map<std::string, double> totals(const OwnedScene& scene, const FilmAccumulator& film, bool materials) {
  std::map<std::string, double> result;
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x)
      for (const MatteWeight& each : film.mattes(x, y)) {
        const MatteNames::Matte& matte = scene.names.mattes[std::size_t(each.matte) - 1];
        result[materials ? scene.names.materials[matte.material] : scene.names.objects[matte.object]] +=
            each.weight;
      }
  return result;
}

TEST(Mattes, OfInstancesAreTheInstances) {
  for (const bool area_light : {false, true})
    for (const bool embree : {false, true}) {
      const OwnedScene scene = owned(instances(area_light), embree);
      const FilmAccumulator film = render_or_throw(scene.device);
      auto objects = totals(scene, film, false), materials = totals(scene, film, true);
      EXPECT_EQ(objects.size(), 4u);
      for (const char* name : {"first", "instance-2", "third", "ball"}) EXPECT_GT(objects[name], 50) << name;
      // They are alike but for the perspective.
      EXPECT_NEAR(objects["first"] / objects["third"], 1, 0.1);
      EXPECT_EQ(materials.size(), area_light ? 3u : 2u);
      EXPECT_GT(materials["clay"], materials["paper"]);
      if (area_light) EXPECT_GT(materials["area_light"], 50);
    }
}

TEST(Mattes, AreNotThereUnlessAskedFor) {
  const SceneDescription description = instances(true);
  const DeviceScene without = build_or_throw(description);
  EXPECT_EQ(without.header.features & FEATURE_MATTES, 0u);
  EXPECT_EQ(without.header.tables.mattes.count, 0);
  EXPECT_EQ(without.header.tables.instance_mattes.count, 0);
  const OwnedScene with = owned(description);
  const FilmAccumulator a = render_or_throw(with.device), b = render_or_throw(without);
  EXPECT_TRUE(b.mattes(20, 8).empty());
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x)
      for (int c = 0; c < 3; ++c) {
        ASSERT_EQ(a.at(x, y).mean[c], b.at(x, y).mean[c]);
        ASSERT_EQ(a.at(x, y).m2[c], b.at(x, y).m2[c]);
      }
}

/// Embree's light may differ, in rays that are in doubt.
void expect_same_mattes(const FilmAccumulator& a, const FilmAccumulator& b) {
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x)
      EXPECT_TRUE(std::ranges::equal(a.mattes(x, y), b.mattes(x, y))) << x << ',' << y;
}

TEST(Mattes, AreTheSameFromEveryBackend) {
  for (const SceneDescription& description : {two_planes(), instances(true)}) {
    const OwnedScene scene = owned(description);
    TestDevice device = native_device();
    const std::uint64_t hash = render_or_throw(scene.device, device).hash();
    for (const Isa isa : usable_isas()) {
      device.options.isa = isa;
      EXPECT_EQ(render_or_throw(scene.device, device).hash(), hash) << isa_name(isa);
    }
    device.options.block_of_one = true;
    EXPECT_EQ(render_or_throw(scene.device, device).hash(), hash);
    const OwnedScene traced = owned(description, true);
    EXPECT_EQ(traced.names, scene.names);
    // The planes' edge is that of the rows: rays that go along it are in doubt.
    if (scene.device.header.tables.instances.count == 0) continue;
    expect_same_mattes(render_or_throw(traced.device), render_or_throw(scene.device));
    EXPECT_EQ(render_or_throw(scene.device, opencl_device()).hash(), hash) << "OpenCL";
  }
}

TEST(Mattes, AreTheSameFromOpenClWithAPathForEachWorkItem) {
  const OwnedScene scene = owned(instances(true));
  TestDevice opencl = opencl_device();
  opencl.options.opencl_tuning.path_per_item = true;
  EXPECT_EQ(render_or_throw(scene.device, opencl).hash(), render_or_throw(scene.device).hash());
}

/// Many narrow strips side by side, more in a pixel than a unit has pairs for.
TEST(Mattes, BeyondWhatAUnitHoldsCountAsNobody) {
  SceneDescription scene = empty_scene(1, 1, 4096, 1);
  scene.integrator = direct_integrator(1, 0);
  scene.camera = {};
  scene.camera.fov = 60;
  constexpr int kStrips = 80;  // of which the camera sees 58
  for (int i = 0; i < kStrips; ++i)
    scene.shapes.push_back(
        named(parallelogram({(i - kStrips / 2) * 0.02, -100, 1}, {0, 200, 0}, {0.02, 0, 0}, kBlackBsdf),
              ("strip-" + std::to_string(i)).c_str()));
  const OwnedScene built = owned(scene);
  TestDevice device = native_device();
  const auto sum = [&](std::uint32_t per_pass, std::size_t& count) {
    device.samples_per_pass = per_pass;
    const FilmAccumulator film = render_or_throw(built.device, device);
    double all = 0;
    for (const MatteWeight& each : film.mattes(0, 0)) all += each.weight;
    count = film.mattes(0, 0).size();
    return all;
  };
  std::size_t few = 0, many = 0;
  EXPECT_LT(sum(4096, few), 4096);
  EXPECT_EQ(few, std::size_t(MAX_MATTE_PAIRS - 1));
  EXPECT_EQ(sum(16, many), 4096);
  EXPECT_EQ(many, 58u);
}

TEST(Mattes, DeviceScenesWithWrongOnesAreRefused) {
  const OwnedScene scene = owned(instances(true));
  const auto error = [&](auto change) {
    DeviceScene changed = scene.device;
    change(changed);
    const auto read = DeviceScene::deserialize(changed.serialize());
    return read ? std::string() : read.error().message;
  };
  const auto set = [](DeviceScene& s, TableSpan span, int index, int value) {
    s.words[span.offset + std::size_t(index)] = std::uint32_t(value);
  };
  EXPECT_EQ(error([](DeviceScene&) {}), "");
  const int mattes = scene.device.header.matte_count;
  // Of the ball that is in the scene itself.
  const int ball = scene.device.header.tables.triangles.count;
  for (const int wrong : {0, -1, mattes + 1, 1 << 30})
    EXPECT_THAT(error([&](DeviceScene& s) { set(s, s.header.tables.mattes, ball, wrong); }),
                HasSubstr("matte that is not there"))
        << wrong;
  for (const int wrong : {0, -5, mattes, 1 << 30, -2'000'000'000})
    EXPECT_THAT(error([&](DeviceScene& s) { set(s, s.header.tables.instance_mattes, 1, wrong); }),
                HasSubstr("matte that is not there"))
        << wrong;
  EXPECT_THAT(error([](DeviceScene& s) { s.header.matte_count = MAX_MATTES + 1; }), HasSubstr("implausible"));
  EXPECT_THAT(error([](DeviceScene& s) { --s.header.tables.mattes.count; }), HasSubstr("do not match"));
  EXPECT_THAT(error([](DeviceScene& s) { --s.header.tables.instance_mattes.count; }),
              HasSubstr("do not match"));
  EXPECT_THAT(error([](DeviceScene& s) { s.header.features &= ~std::uint64_t(FEATURE_MATTES); }),
              HasSubstr("without their feature bit"));
}

}  // namespace
}  // namespace penumbra::mattes_test
