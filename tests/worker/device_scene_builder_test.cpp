// From a scene description to a device scene: recentring, sides, cameras, tables, errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/device_scene.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"
#include "tests/worker/built_scenes.h"
#include "tests/worker/device_scenes.h"

namespace penumbra {
namespace {

using glm::dvec3;

SceneDescription moved(SceneDescription scene, const dvec3& shift) {
  for (Shape& shape : scene.shapes) {
    if (auto* mesh = std::get_if<Mesh>(&shape.geometry))
      for (dvec3& p : mesh->positions) p += shift;
    if (auto* sphere = std::get_if<Sphere>(&shape.geometry)) sphere->center += shift;
    if (auto* disk = std::get_if<Disk>(&shape.geometry)) disk->center += shift;
    if (auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) cylinder->center += shift;
    if (auto* curves = std::get_if<Curves>(&shape.geometry))
      for (Curve& curve : curves->curves)
        for (ControlPoint& point : curve) point.position += shift;
  }
  for (ParticipatingMedium& medium : scene.media)
    for (std::optional<GridVolume>* grid : {&medium.density, &medium.albedo_grid, &medium.emission_grid})
      if (*grid) (*grid)->to_world[3] += glm::dvec4(shift, 0);
  for (Emitter& emitter : scene.emitters)
    if (auto* point = std::get_if<PointLight>(&emitter)) point->position += shift;
  scene.camera.to_world[3] += glm::dvec4(shift, 0);
  for (ShapeInstance& instance : scene.instances) instance.to_world[3] += glm::dvec4(shift, 0);
  return scene;
}

TEST(Recentring, AShiftThatRoundsNothingChangesNothing) {
  // Dyadic positions and a shift by a whole number are exact in double.
  SceneDescription scene = empty_scene(16, 12, 4, 1);
  const int grey = add_diffuse(scene, 0.5f);
  scene.shapes.push_back(parallelogram(dvec3(-1, -1, 0), dvec3(2, 0, 0), dvec3(0, 2, 0), grey));
  scene.shapes.push_back(
      parallelogram(dvec3(-0.5, 0.75, 0.25), dvec3(1, 0, 0), dvec3(0, 0, 0.5), kBlackBsdf, 4.0f));
  scene.camera = look_at(dvec3(0, 0, 4), dvec3(0, 0, 0), dvec3(0, 1, 0), 40);
  const DeviceScene here = build(scene), there = build(moved(scene, dvec3(1e6, -3e6, 2e6)));
  EXPECT_EQ(here.words, there.words);
  EXPECT_EQ(render_or_throw(here).hash(), render_or_throw(there).hash());
}

TEST(Recentring, FarAwayScenesLookTheSame) {
  for (const NamedScene& named : device_scenes()) {
    const SceneDescription scene = named.make();
    // Textures are steep: small steps of positions show everywhere.
    if (scene.shapes.empty() || !scene.textures.empty()) continue;
    const FilmAccumulator here = render_or_throw(build(scene));
    // Positions round to 2^-33 of a million; a few paths near edges take another turn.
    const FilmAccumulator there = render_or_throw(build(moved(scene, dvec3(1e6, 1e6, -1e6))));
    int different = 0;
    for (int y = 0; y < here.height(); ++y)
      for (int x = 0; x < here.width(); ++x) {
        const double a = here.at(x, y).mean[1], b = there.at(x, y).mean[1];
        different += std::abs(a - b) > 1e-3 * (std::abs(a) + 0.01) ? 1 : 0;
      }
    EXPECT_LE(different, here.width() * here.height() / 50) << named.name;
  }
}

TEST(Recentring, TheCentreOfTheShapesIsTheOrigin) {
  SceneDescription scene = empty_scene(4, 4, 1, 1);
  scene.shapes.push_back(parallelogram(dvec3(10, 20, 30), dvec3(2, 0, 0), dvec3(0, 4, 0), kBlackBsdf));
  const DeviceScene built = build(scene);
  float low = 1e9f, high = -1e9f;
  for (const Triangle& t : triangles_of(built))
    for (const vec3& p : {t.p0, t.p1, t.p2}) {
      low = std::min(low, p.y);
      high = std::max(high, p.y);
      EXPECT_EQ(p.z, 0);
    }
  EXPECT_EQ(low, -2);
  EXPECT_EQ(high, 2);
  EXPECT_EQ(built.header.camera.origin.x, -11);
  EXPECT_EQ(built.header.camera.origin.y, -22);
  EXPECT_EQ(built.header.camera.origin.z, -30);
  EXPECT_EQ(built.header.dropped_triangles, 0);
}

/// One triangle in z = 0 that faces up, with different materials on its sides.
SceneDescription two_sided_triangle() {
  SceneDescription scene = empty_scene(4, 4, 1, 1);
  const int front = add_diffuse(scene, 0.25f), back = add_diffuse(scene, 0.75f);
  Shape shape = triangles(std::vector{dvec3(-1, -1, 0), dvec3(1, -1, 0), dvec3(0, 1, 0)}, front, 2.0f);
  shape.back_bsdf = back;
  scene.shapes.push_back(shape);
  return scene;
}

float up(const Triangle& t) { return cross3(sub(t.p1, t.p0), sub(t.p2, t.p0)).z; }
float reflectance(const DeviceScene& scene, int material) {
  return table<Material>(scene, scene.header.tables.materials)[std::size_t(material)].diffuse.x;
}

TEST(Sides, TrianglesFaceTheirFront) {
  SceneDescription scene = two_sided_triangle();
  const DeviceScene plain = build(scene);
  ASSERT_EQ(plain.header.tables.triangles.count, 1);
  const Triangle t = triangles_of(plain)[0];
  EXPECT_GT(up(t), 0);
  EXPECT_EQ(reflectance(plain, t.front), 0.25f);
  EXPECT_EQ(reflectance(plain, t.back), 0.75f);
  EXPECT_EQ(t.light, 0);

  std::get<Mesh>(scene.shapes[0].geometry).normals = std::vector<glm::vec3>(3, glm::vec3(0, 0, 1));
  scene.shapes[0].flip_normals = true;
  const DeviceScene flipped = build(scene);
  const Triangle f = triangles_of(flipped)[0];
  EXPECT_LT(up(f), 0);
  // The front material goes with the front side.
  EXPECT_EQ(reflectance(flipped, f.front), 0.25f);
  EXPECT_EQ(reflectance(flipped, f.back), 0.75f);
  EXPECT_EQ(table<VertexNormals>(flipped, flipped.header.tables.normals)[0].n0.z, -1);
  const Light light = lights_of(flipped)[0];
  EXPECT_LT(cross3(sub(light.p1, light.p0), sub(light.p2, light.p0)).z, 0)
      << "the light shines from the front";
}

TEST(Sides, QuadricsFaceTheirFront) {
  SceneDescription scene = empty_scene(4, 4, 1, 1);
  Shape sphere, disk;
  sphere.geometry = Sphere{dvec3(0), 2};
  disk.geometry = Disk{dvec3(0), dvec3(0, 0, 1), 1};
  sphere.radiance = disk.radiance = glm::vec3(1);
  scene.shapes = {sphere, disk};
  for (bool flip : {false, true}) {
    for (Shape& shape : scene.shapes) shape.flip_normals = flip;
    const DeviceScene built = build(scene);
    const auto quadrics = quadrics_of(built);
    ASSERT_EQ(quadrics.size(), 2u);
    EXPECT_EQ(quadrics[0].orientation, flip ? -1 : 1);
    EXPECT_EQ(quadrics[1].normal.z, flip ? -1 : 1);
    EXPECT_EQ(lights_of(built)[0].p2.y, flip ? -1 : 1);
    EXPECT_EQ(lights_of(built)[1].p1.z, flip ? -1 : 1);
  }
}

TEST(Sides, OnlyTheFrontEmits) {
  // The camera looks at the triangle from above, then from below.
  SceneDescription scene = two_sided_triangle();
  param::max_depth(scene.integrator) = 1;
  for (bool flip : {false, true})
    for (double side : {1.0, -1.0}) {
      scene.shapes[0].flip_normals = flip;
      scene.camera = look_at(dvec3(0, -0.2, 3 * side), dvec3(0, -0.2, 0), dvec3(0, 1, 0), 1);
      const bool front = (side > 0) != flip;
      EXPECT_EQ(render_or_throw(build(scene)).at(2, 2).mean[0], front ? 2 : 0);
    }
}

TEST(Areas, AreThoseOfTheShapes) {
  SceneDescription scene = empty_scene(4, 4, 1, 1);
  Shape sphere, disk;
  sphere.geometry = Sphere{dvec3(0), 2};
  disk.geometry = Disk{dvec3(0), dvec3(0, 0, 1), 3};
  sphere.radiance = disk.radiance = glm::vec3(1);
  scene.shapes = {sphere, disk,
                  triangles(std::vector{dvec3(0), dvec3(2, 0, 0), dvec3(0, 3, 0)}, kBlackBsdf, 1.0f)};
  const auto lights = lights_of(build(scene));
  ASSERT_EQ(lights.size(), 3u);
  const double areas[] = {16 * std::numbers::pi, 9 * std::numbers::pi, 3};
  const double total = areas[0] + areas[1] + areas[2];
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(lights[i].area, areas[i], 1e-6 * areas[i]);
    // Equal radiance: power goes with area, in cells of 1/1024.
    EXPECT_NEAR(lights[i].pmf, areas[i] / total, 1.0 / 1024);
  }
}

TEST(Camera, FieldOfViewAlongEveryAxis) {
  for (auto [width, height] : {std::pair{200, 100}, {100, 200}, {150, 150}})
    for (FovAxis axis : {FovAxis::kX, FovAxis::kY, FovAxis::kDiagonal, FovAxis::kSmaller, FovAxis::kLarger}) {
      SceneDescription scene = empty_scene(width, height, 1, 1);
      scene.camera.fov = 70;
      scene.camera.fov_axis = axis;
      const SceneHeader h = build(scene).header;
      // Half extents at distance 1: pixels are square, and the named one is tan(35 degrees).
      const double x = std::sqrt(double(dot3(h.camera.x, h.camera.x))),
                   y = std::sqrt(double(dot3(h.camera.y, h.camera.y)));
      EXPECT_NEAR(x / y, double(width) / height, 1e-6);
      const bool wide = width > height;
      const double named = axis == FovAxis::kX          ? x
                           : axis == FovAxis::kY        ? y
                           : axis == FovAxis::kDiagonal ? std::hypot(x, y)
                           : axis == FovAxis::kSmaller  ? (wide ? y : x)
                                                        : (wide ? x : y);
      EXPECT_NEAR(named, std::tan(35 * std::numbers::pi / 180), 1e-6)
          << width << "x" << height << " axis " << int(axis);
    }
}

TEST(Camera, AScaleHasNoEffectOnDirections) {
  SceneDescription scene = diffuse_box();
  const SceneHeader plain = build(scene).header;
  for (int k = 0; k < 3; ++k) scene.camera.to_world[k] *= 7.0 + k;
  const SceneHeader scaled = build(scene).header;
  EXPECT_NEAR(length3(sub(plain.camera.x, scaled.camera.x)), 0, 1e-6);
  EXPECT_NEAR(length3(sub(plain.camera.y, scaled.camera.y)), 0, 1e-6);
  EXPECT_NEAR(length3(sub(plain.camera.z, scaled.camera.z)), 0, 1e-6);
  EXPECT_NEAR(length3(scaled.camera.z), 1, 1e-6);
}

DeviceScene build_with_uv(const SceneDescription& scene) {
  DeviceSceneOptions options;
  options.intersector = IntersectorChoice::kPortable;
  options.surface_uv = true;
  auto built = build_device_scene(scene, options);
  if (!built) throw std::runtime_error(built.error().message);
  return std::move(*built);
}

TEST(TextureCoordinates, AreThereIfTheyAreWanted) {
  for (const NamedScene& named : device_scenes()) {
    const SceneDescription scene = named.make();
    const DeviceScene without = build(scene);
    if ((without.header.features & FEATURE_UV) != 0u) continue;  // which wants them anyway
    const DeviceScene with = build_with_uv(scene);
    EXPECT_EQ(with.header.features, without.header.features | FEATURE_UV) << named.name;
    EXPECT_EQ(without.header.tables.vertex_uvs.count, 0);
    EXPECT_EQ(without.header.tables.light_triangles.count, 0);
    EXPECT_EQ(with.header.tables.vertex_uvs.count, with.header.tables.triangles.count);
    EXPECT_EQ(with.header.tables.light_triangles.count, with.header.tables.lights.count);
    const auto checked = check_device_scene(with);
    EXPECT_TRUE(checked) << checked.error().message;
    EXPECT_EQ(render_or_throw(with).hash(), render_or_throw(without).hash()) << named.name;
  }
}

TEST(TextureCoordinates, AreTheMeshesOrBarycentricAndFollowItsVertices) {
  SceneDescription scene = empty_scene(4, 4, 1, 1);
  const std::vector corners{dvec3(-1, -1, 0), dvec3(1, -1, 0), dvec3(0, 1, 0)};
  for (const bool flipped : {false, true})
    for (const bool given : {false, true}) {
      Shape shape = triangles(corners, kBlackBsdf);
      shape.flip_normals = flipped;
      if (given) std::get<Mesh>(shape.geometry).texcoords = {{0.1f, 0.2f}, {0.3f, 0.4f}, {0.5f, 0.6f}};
      scene.shapes.push_back(shape);
    }
  const DeviceScene built = build_with_uv(scene);
  const auto uvs = table<VertexUvs>(built, built.header.tables.vertex_uvs);
  ASSERT_EQ(uvs.size(), 4u);
  const auto expect = [](const VertexUvs& at, const VertexUvs& expected) {
    EXPECT_TRUE(at.u0 == expected.u0 && at.v0 == expected.v0 && at.u1 == expected.u1 &&
                at.v1 == expected.v1 && at.u2 == expected.u2 && at.v2 == expected.v2);
  };
  expect(uvs[0], {0, 0, 1, 0, 0, 1});
  expect(uvs[1], {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f});
  expect(uvs[2], {0, 0, 0, 1, 1, 0});
  expect(uvs[3], {0.1f, 0.2f, 0.5f, 0.6f, 0.3f, 0.4f});
}

TEST(TextureCoordinates, OfLightsAreThoseOfTheirTriangles) {
  SceneDescription scene = empty_scene(4, 4, 1, 1);
  param::emitter_sampling(scene.integrator) = EmitterSampling::kSolidAngle;
  scene.shapes.push_back(parallelogram(dvec3(0, 0, 5), dvec3(1, 0, 0), dvec3(0, 1, 0), kBlackBsdf));
  scene.shapes.push_back(parallelogram(dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(0, 2, 0), kBlackBsdf, 1.0f));
  // The same rectangle, its first triangle twice: that one is no second part.
  Shape repeated = scene.shapes.back();
  auto& mesh = std::get<Mesh>(repeated.geometry);
  for (dvec3& p : mesh.positions) p.z = 1;
  const std::vector<dvec3> three{dvec3(0, 0, 2), dvec3(1, 0, 2), dvec3(0, 1, 2)};
  mesh.triangles.insert(mesh.triangles.begin() + 1, mesh.triangles[0]);
  scene.shapes.push_back(repeated);
  scene.shapes.push_back(triangles(three, kBlackBsdf, 1.0f));
  scene.emitters.emplace_back(PointLight{});
  const DeviceScene built = build_with_uv(scene);
  const auto parts = table<LightTriangles>(built, built.header.tables.light_triangles);
  ASSERT_EQ(parts.size(), 4u);
  const auto expect = [&](int light, int kind, int first, int second) {
    EXPECT_EQ(lights_of(built)[std::size_t(light)].kind, kind);
    EXPECT_EQ(parts[std::size_t(light)].first, first);
    EXPECT_EQ(parts[std::size_t(light)].second, second);
  };
  expect(0, LIGHT_RECTANGLE, 2, 3);
  expect(1, LIGHT_RECTANGLE, 4, 6);
  expect(2, LIGHT_TRIANGLE, 7, 7);
  expect(3, LIGHT_POINT, -1, -1);
}

TEST(Dummies, ASceneOfOnlyAnEnvironmentShowsIt) {
  // Kernels read a triangle, a quadric and its material for rays that miss; here are none, and the variant
  // that has all features is used.
  for (IntersectorChoice intersector : {IntersectorChoice::kPortable, IntersectorChoice::kEmbree})
    for (int width : {24, 1}) {  // whole vectors of paths, and a part of one
      SceneDescription description = environment_alone();
      resize_film(description, width, 1);
      const DeviceScene scene = build(description, true, intersector);
      EXPECT_EQ(scene.header.tables.triangles.count, 0);
      const FilmAccumulator film = render_or_throw(scene);
      for (int x = 0; x < width; ++x) {
        EXPECT_EQ(film.at(x, 0).mean[0], 0.25);
        EXPECT_EQ(film.at(x, 0).mean[2], 0.75);
      }
    }
}

TEST(Dummies, AnEmptySceneIsBlack) {
  SceneDescription scene = empty_scene(8, 8, 2, 1);
  add_diffuse(scene, 0.5f);
  resize_film(scene, 5, 5);
  for (IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kDirect}) {
    use(scene.integrator, kind);
    EXPECT_EQ(render_or_throw(build(scene)).at(4, 4).mean[0], 0);
    EXPECT_EQ(render_or_throw(build(scene, true, IntersectorChoice::kEmbree)).at(4, 4).mean[0], 0);
  }
}

TEST(DegenerateTriangles, AreLeftOutAndCounted) {
  SceneDescription scene = empty_scene(4, 4, 1, 1);
  scene.shapes.push_back(
      triangles(std::vector{dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(0, 1, 0),   // whole
                            dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(1, 0, 0),   // two vertices alike
                            dvec3(0, 0, 0), dvec3(1, 1, 1), dvec3(2, 2, 2)},  // collinear
                kBlackBsdf, 1.0f));
  const SceneHeader h = build(scene).header;
  EXPECT_EQ(h.tables.triangles.count, 1);
  EXPECT_EQ(h.dropped_triangles, 2);
  EXPECT_EQ(h.tables.lights.count, 1);
}

TEST(Errors, PositionsTooLargeForSinglePrecision) {
  const auto message = [](auto change) {
    SceneDescription scene = everything();
    change(scene);
    const auto built = build_device_scene(scene, {});
    return built ? std::string("built") : built.error().message;
  };
  const std::string too_large = "too large for single precision";
  EXPECT_NE(
      message([](auto& s) { std::get<Mesh>(s.shapes[0].geometry).positions[0].x = 1e39; }).find(too_large),
      std::string::npos);
  EXPECT_NE(message([](auto& s) {
              std::get<Mesh>(s.shapes[0].geometry).positions[0].x = std::nan("");
            }).find(too_large),
            std::string::npos);
  EXPECT_NE(message([](auto& s) { s.camera.to_world[3].y = 1e39; }).find(too_large), std::string::npos);
  EXPECT_NE(
      message([](auto& s) { std::get<PointLight>(s.emitters.at(0)).position.z = 1e39; }).find(too_large),
      std::string::npos);
  for (Shape shape : everything().shapes) {
    if (std::holds_alternative<Mesh>(shape.geometry)) continue;
    EXPECT_NE(message([&](auto& s) {
                s.shapes = {shape};
                if (auto* sphere = std::get_if<Sphere>(&s.shapes[0].geometry)) sphere->radius = 1e39;
                if (auto* disk = std::get_if<Disk>(&s.shapes[0].geometry)) disk->radius = 1e39;
              }).find(too_large),
              std::string::npos);
  }
}

TEST(Builder, IsAPureFunction) {
  for (const NamedScene& named : device_scenes()) {
    const DeviceScene a = build(named.make()), b = build(named.make());
    EXPECT_EQ(a.serialize(), b.serialize()) << named.name;
  }
}

}  // namespace
}  // namespace penumbra
