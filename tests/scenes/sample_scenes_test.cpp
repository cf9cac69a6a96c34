// The sample scenes: each is read without a warning, and is what scenes/README.md says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "scenes/scene_reader.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

SceneDescription read(const std::string& name, const ReadOptions& options = {}) {
  const auto scene = read_scene(std::filesystem::path(PENUMBRA_SOURCE_DIR) / "scenes" / name, options);
  EXPECT_TRUE(scene) << scene.error().message;
  if (!scene) return {};
  EXPECT_THAT(scene->warnings, IsEmpty());
  return *scene;
}

struct TrianglePlane {
  glm::dvec3 center, normal;
};

std::vector<TrianglePlane> triangles_of(const Shape& shape) {
  std::vector<TrianglePlane> result;
  if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
    for (const glm::uvec3& t : mesh->triangles) {
      const glm::dvec3 &a = mesh->positions[t.x], &b = mesh->positions[t.y], &c = mesh->positions[t.z];
      const double sign = shape.flip_normals ? -1.0 : 1.0;
      result.push_back({(a + b + c) / 3.0, sign * glm::normalize(glm::cross(b - a, c - a))});
    }
  }
  return result;
}

std::size_t count_triangles(const SceneDescription& scene) {
  std::size_t count = 0;
  for (const Shape& shape : scene.shapes) count += triangles_of(shape).size();
  return count;
}

/// Where a point is seen, in camera coordinates.
glm::dvec3 seen(const SceneDescription& scene, glm::dvec3 point) {
  return glm::dvec3(glm::inverse(scene.camera.to_world) * glm::dvec4(point, 1.0));
}

void expect_rooms_face_inwards(const SceneDescription& scene, glm::dvec3 middle) {
  for (const Shape& shape : scene.shapes) {
    const bool block = shape.name.ends_with("block");
    glm::dvec3 center = middle;
    if (block) {
      center = glm::dvec3(0.0);
      const auto triangles = triangles_of(shape);
      for (const TrianglePlane& t : triangles) center += t.center / double(triangles.size());
    }
    for (const TrianglePlane& t : triangles_of(shape)) {
      EXPECT_EQ(glm::dot(t.normal, center - t.center) > 0.0, !block) << shape.name;
    }
  }
}

TEST(SampleScenes, Cornell) {
  const SceneDescription scene = read("cornell/cornell.xml");
  EXPECT_EQ(count_triangles(scene), 32u);
  EXPECT_EQ(scene.film.width, 512);
  EXPECT_EQ(scene.sampler.spp, 64u);
  expect_rooms_face_inwards(scene, {278, 273, 279});
  // The red wall, at x = 556, is to the left: camera +x.
  EXPECT_GT(seen(scene, {556, 273, 279}).x, 0.0);
  EXPECT_GT(seen(scene, {278, 548, 279}).y, 0.0);
  EXPECT_EQ(read("cornell/cornell.xml", {.defines = {{"resolution", "1024"}}}).film.crop_height, 1024);
}

TEST(SampleScenes, CornellSmall) {
  const SceneDescription scene = read("cornell-small/cornell-small.xml");
  EXPECT_EQ(count_triangles(scene), 36u);
  EXPECT_EQ(scene.film.width, 256);
  expect_rooms_face_inwards(scene, {0, 1, 0});
  EXPECT_GT(seen(scene, {-1, 1, 0}).x, 0.0);
  EXPECT_NEAR(seen(scene, {0, 1, 0}).z, 6.8, 1e-12);
}

TEST(SampleScenes, VeachMis) {
  const SceneDescription scene = read("veach-mis/veach-mis.xml");
  int plates = 0, lights = 0;
  for (const Shape& shape : scene.shapes) {
    if (shape.name.starts_with("plate")) {
      ++plates;
      const auto& bsdf = scene.bsdfs.at(std::size_t(shape.front_bsdf));
      EXPECT_TRUE(std::holds_alternative<PhongBsdf>(bsdf.model));
      // The camera and the lights' middle are mirror images about the plate's normal.
      const TrianglePlane a = triangles_of(shape)[0], b = triangles_of(shape)[1];
      const glm::dvec3 middle = 0.5 * (a.center + b.center);
      const glm::dvec3 in = glm::normalize(glm::dvec3(0, 1.2, -1) - middle);
      const glm::dvec3 out = glm::normalize(glm::dvec3(0, 2.5, 15) - middle);
      EXPECT_GT(glm::dot(glm::normalize(in + out), a.normal), 1.0 - 1e-9);
    }
    if (shape.radiance && shape.name != "light-fill") {
      ++lights;
      // One power: 4 pi r² pi L the same, in the sum of the channels.
      const double r = std::get<Sphere>(shape.geometry).radius;
      const double power = r * r * double(shape.radiance->x + shape.radiance->y + shape.radiance->z);
      EXPECT_NEAR(power, 2.1, 0.2) << shape.name;
    }
  }
  EXPECT_EQ(plates, 4);
  EXPECT_EQ(lights, 4);
  EXPECT_EQ(kind_of(scene.integrator), IntegratorKind::kDirect);
  EXPECT_EQ(
      param::bsdf_samples(read("veach-mis/veach-mis.xml", {.defines = {{"bsdf_samples", "0"}}}).integrator),
      0);
}

TEST(SampleScenes, Furnace) {
  const SceneDescription scene =
      read("furnace/furnace.xml", {.defines = {{"albedo", "0.8"}, {"integrator", "direct"}}});
  ASSERT_THAT(scene.shapes, SizeIs(1));
  for (const TrianglePlane& t : triangles_of(scene.shapes[0])) {
    EXPECT_NEAR(glm::dot(t.normal, -t.center), 0.5, 1e-12);
  }
  EXPECT_EQ(std::get<DiffuseBsdf>(scene.bsdfs.at(0).model).reflectance, glm::vec3(0.8f));
  EXPECT_EQ(scene.shapes[0].radiance, glm::vec3(1));
  EXPECT_EQ(scene.camera.fov, 10.0);
  const SceneDescription sphere = read("furnace/unit-sphere.xml");
  EXPECT_EQ(std::get<Sphere>(sphere.shapes.at(0).geometry).radius, 1.0);
  EXPECT_TRUE(sphere.shapes[0].flip_normals);
  EXPECT_EQ(sphere.shapes[0].radiance, glm::vec3(0.5f));
}

/// E / pi times the albedo, by Lambert's formula: E = L / 2 sum angle (n . edge normal).
double lambert_radiance(const Mesh& light, double albedo) {
  const glm::uvec3 t = light.triangles.at(0);
  glm::dvec3 v[3];
  for (int i = 0; i < 3; ++i) v[i] = glm::normalize(light.positions[t[i]]);
  double irradiance = 0.0;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 c = glm::cross(v[i], v[(i + 1) % 3]);
    irradiance += 0.5 * std::atan2(glm::length(c), glm::dot(v[i], v[(i + 1) % 3])) * c.y / glm::length(c);
  }
  return albedo / 3.14159265358979323846 * std::abs(irradiance);
}

TEST(SampleScenes, PolygonLights) {
  const double exact[] = {0.089839259, 0.022920040, 0.053419540, 0.020531391, 0.261739859};
  for (int i = 1; i <= 5; ++i) {
    const std::string number = std::to_string(i);
    const SceneDescription scene =
        read("polygon-lights/polygon-lights.xml", {.defines = {{"light", number}}});
    const SceneDescription same = read("polygon-lights/polygon-" + number + ".xml");
    ASSERT_THAT(scene.shapes, SizeIs(2));
    const Mesh& light = std::get<Mesh>(scene.shapes[1].geometry);
    EXPECT_EQ(light.positions, std::get<Mesh>(same.shapes.at(1).geometry).positions);
    // The vertices have six digits.
    EXPECT_NEAR(lambert_radiance(light, 0.5), exact[i - 1], 1e-6);
    const TrianglePlane triangle = triangles_of(scene.shapes[1])[0];
    EXPECT_GT(glm::dot(triangle.normal, -triangle.center), 0.0) << "it shines away from the origin";
    EXPECT_EQ(triangles_of(scene.shapes[0])[0].normal, glm::dvec3(0, 1, 0));
    EXPECT_EQ(scene.camera.fov, 1e-6);
    EXPECT_EQ(scene.film.crop_width * scene.film.crop_height, 1);
  }
}

}  // namespace
}  // namespace penumbra
