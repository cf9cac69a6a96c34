// A scene with instances equals the scene with copies of the shapes, up to rounding in single precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "scenes/instances.h"
#include "scenes/transform.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/every_texture.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"
#include "tests/worker/device_scenes.h"

namespace penumbra {
namespace {

using glm::dvec3;

/// Of pixels of two renders of the same samples, those that differ by more than some roundings: where a ray
/// goes past a rim on the other side.
void expect_same_image(SceneDescription scene, const TestDevice& device, double most_differing) {
  // The way that pays is found by where shapes are, among which those of groups do not count.
  each_shape(scene, [](Shape& shape) { shape.sampling = EmitterSampling::kArea; });
  // Instances count as boxes about their groups: the scene's own bounds are to be the same.
  for (const double corner : {-3.0, 3.0})
    scene.shapes.push_back(
        parallelogram(dvec3(corner), dvec3(-0.1 * corner, 0, 0), dvec3(0, -0.1 * corner, 0), 0));
  const auto flat = without_instances(scene);
  ASSERT_TRUE(flat) << flat.error().message;
  const statistics::Image a = mean_image(render_or_throw(scene, device));
  const statistics::Image b = mean_image(render_or_throw(*flat, device));
  double sum_a = 0, sum_b = 0;
  int differing = 0, bright = 0;
  for (int y = 0; y < scene.film.height; ++y)
    for (int x = 0; x < scene.film.width; ++x) {
      const double ours = a.at(x, y, 1), theirs = b.at(x, y, 1);
      sum_a += ours;
      sum_b += theirs;
      bright += ours > 0 ? 1 : 0;
      differing += std::abs(ours - theirs) > 1e-3 * std::max(ours, theirs) ? 1 : 0;
    }
  const int pixels = scene.film.width * scene.film.height;
  EXPECT_GT(bright, pixels / 2);
  EXPECT_LE(differing, most_differing * pixels) << "of " << pixels;
  EXPECT_NEAR(sum_a / sum_b, 1, 5e-3);
}

struct Tracing {
  std::string name;
  TestDevice (*device)();
  bool embree;
};
void PrintTo(const Tracing& tested, std::ostream* out) { *out << tested.name; }

class InstancedScenes : public testing::TestWithParam<Tracing> {
 protected:
  static TestDevice device() {
    TestDevice device = GetParam().device();
    device.embree = GetParam().embree;
    return device;
  }
};

/// Similarities only: spheres and disks stay such. Seen directly, then after two more surfaces.
SceneDescription similar_instances(int max_depth) {
  SceneDescription scene = instances();
  scene.groups[1].instances[1].to_world = translation({0, 0.9, 0}) * scaling({-0.7, 0.7, 0.7});
  scene.integrator = path_integrator(DirectSampling::kMis);
  param::max_depth(scene.integrator) = max_depth;
  resize_film(scene, 48, 36);
  return scene;
}

TEST_P(InstancedScenes, AreThoseOfTheirShapesInPlace) {
  expect_same_image(similar_instances(2), device(), 0.02);
  expect_same_image(similar_instances(4), device(), 0.06);
}

TEST_P(InstancedScenes, WithTheirTextures) {
  SceneDescription scene = similar_instances(2);
  // Vertices get colours too, where they are the scene's.
  std::vector<Shape>& inside = scene.groups[0].shapes;
  // Barycentric coordinates would be those of triangles that a mirror winds the other way.
  for (Shape& shape : inside)
    if (auto* mesh = std::get_if<Mesh>(&shape.geometry))
      for (const dvec3& p : mesh->positions) mesh->texcoords.emplace_back(0.3 * p.x + p.y, p.z - 0.2 * p.x);
  const auto own = std::ptrdiff_t(scene.shapes.size());
  scene.shapes.insert(scene.shapes.end(), inside.begin(), inside.end());
  add_every_texture(scene);
  inside.assign(scene.shapes.begin() + own, scene.shapes.end());
  scene.shapes.erase(scene.shapes.begin() + own, scene.shapes.end());
  expect_same_image(scene, device(), 0.03);
}

TEST_P(InstancedScenes, OfStretchedMeshes) {
  SceneDescription scene = instances();
  std::erase_if(scene.groups[0].shapes,
                [](const Shape& shape) { return !std::holds_alternative<Mesh>(shape.geometry); });
  // Normals are interpolated in the group, as in Mitsuba: not those between the transformed ones of vertices.
  for (Shape& shape : scene.groups[0].shapes) std::get<Mesh>(shape.geometry).normals.clear();
  param::max_depth(scene.integrator) = 2;
  resize_film(scene, 48, 36);
  expect_same_image(scene, device(), 0.02);
}

TEST_P(InstancedScenes, ByEveryIntegrator) {
  SceneDescription scene = similar_instances(2);
  scene.integrator = direct_integrator(2, 2);
  expect_same_image(scene, device(), 0.03);
  use(scene.integrator, IntegratorKind::kWhitted);
  limit_depth(scene.integrator, 2);
  expect_same_image(scene, device(), 0.03);
  use(scene.integrator, IntegratorKind::kAmbientOcclusion);
  expect_same_image(scene, device(), 0.03);
}

/// Those that emit are in the scene where they are placed, each a light.
TEST_P(InstancedScenes, OfEmitters) {
  SceneDescription scene = similar_instances(3);
  Shape area_light = parallelogram(dvec3(-0.2, 0.8, 0), dvec3(0.4, 0, 0), dvec3(0, 0, 0.4), kBlackBsdf, 4.0f);
  scene.groups[0].shapes.push_back(area_light);
  expect_same_image(scene, device(), 0.05);
  each_shape(scene, [](Shape& shape) { shape.sampling = EmitterSampling::kArea; });
  const DeviceScene built = build_or_throw(scene);
  EXPECT_EQ(built.header.tables.lights.count, 1 + 1 + 12)
      << "the ceiling's, the tube and those of the instances";
}

// OpenCL gives the bits of native code: devices_test.
const Tracing kTracings[] = {{"Portable", native_device, false}, {"Embree", native_device, true}};
INSTANTIATE_TEST_SUITE_P(All, InstancedScenes, testing::ValuesIn(kTracings),
                         [](const auto& tested) { return tested.param.name; });

/// Groups are stored once, whatever the number of places.
TEST(InstancedGeometry, IsStoredOnce) {
  SceneDescription scene = instances();
  const DeviceScene few = build_or_throw(scene);
  const std::vector<ShapeInstance> placed = scene.instances;
  for (int i = 1; i < 1000; ++i) scene.instances.insert(scene.instances.end(), placed.begin(), placed.end());
  const DeviceScene many = build_or_throw(scene);
  EXPECT_EQ(many.header.tables.triangles.count, few.header.tables.triangles.count);
  EXPECT_EQ(many.header.tables.triangle_leaves.count, few.header.tables.triangle_leaves.count);
  EXPECT_EQ(many.header.tables.instances.count, 1000 * few.header.tables.instances.count);
  const double bytes = 4.0 * double(many.words.size()) / many.header.tables.instances.count;
  EXPECT_LT(bytes, 256) << "of each instance, its part of the hierarchy included";
}

}  // namespace
}  // namespace penumbra
