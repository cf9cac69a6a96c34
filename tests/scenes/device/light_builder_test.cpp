// The builder's tables of lights: kinds, order, areas, probabilities, and no unneeded tables.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "tests/scenes/device/light_builder_pieces.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using enum EmitterSampling;

// --- kinds

TEST(LightBuilder, SamplingIsTheShapesElseTheDefaultElseTheKinds) {
  for (const EmitterSampling by_default : kSamplings)
    for (const EmitterSampling own : kSamplings) {
      LightBuilder builder(by_default, false);
      builder.add_triangles(rectangle(), emitter(glm::vec3(1), own));
      Light sphere{};
      sphere.kind = LIGHT_SPHERE;
      builder.add_quadric(sphere, emitter(glm::vec3(1), own), 1);
      const EmitterSampling wanted = own == kAuto ? by_default : own;
      const int code = wanted == kSolidAngle  ? EMITTER_SOLID_ANGLE
                       : wanted == kProjected ? EMITTER_PROJECTED
                                              : EMITTER_AREA;
      EXPECT_EQ(builder.lights().front().sampling, code) << int(by_default) << " " << int(own);
      EXPECT_EQ(builder.lights().back().sampling, wanted == kAuto ? EMITTER_SOLID_ANGLE : code);
      EXPECT_EQ(builder.features(), code == EMITTER_SOLID_ANGLE ? std::uint64_t(FEATURE_SOLID_ANGLE)
                                    : code == EMITTER_PROJECTED ? std::uint64_t(FEATURE_PROJECTED)
                                                                : 0u);
    }
}

TEST(LightBuilder, ARectangleIsOneLightUnlessSampledByProjectedSolidAngle) {
  for (const bool polygons : {false, true})
    for (const EmitterSampling sampling : kSamplings) {
      LightBuilder builder(kAuto, polygons);
      const Triangles triangles = rectangle();
      const std::vector<int> index = builder.add_triangles(triangles, emitter(glm::vec3(1), sampling));
      check(builder, triangles, index);
      EXPECT_THAT(builder.polygons(), SizeIs(polygons ? 1 : 0));
      EXPECT_EQ((builder.features() & FEATURE_POLYGONS) != 0, polygons);
      for (const Light& light : builder.lights()) EXPECT_EQ(light.polygon, polygons ? 0 : -1);
      if (sampling != kProjected) {
        ASSERT_THAT(builder.lights(), SizeIs(1));
        EXPECT_EQ(builder.lights()[0].kind, LIGHT_RECTANGLE);
        EXPECT_EQ(builder.lights()[0].area, 6);
        EXPECT_THAT(index, ElementsAre(0, 0));
      } else {
        ASSERT_THAT(builder.lights(), SizeIs(2));
        EXPECT_EQ(builder.lights()[1].kind, LIGHT_TRIANGLE);
        EXPECT_EQ(builder.lights()[1].area, 3);
        EXPECT_THAT(index, ElementsAre(0, 1));
      }
    }
}

TEST(LightBuilder, ARectanglesCornersGoAroundItsFront) {
  for (const bool back : {false, true})
    for (const bool diagonal : {false, true}) {
      Triangles triangles = parallelogram(tilted(1, 1), tilted(4, 1), tilted(1, 3));
      if (diagonal) {  // the other one
        const vec3 a = tilted(1, 1), b = tilted(4, 1), c = tilted(4, 3), d = tilted(1, 3);
        triangles = {{a, b, d}, {b, c, d}};
      }
      if (back) triangles = turned(triangles);
      const LightBuilder builder = build(triangles, emitter(glm::vec3(1), kSolidAngle), false);
      ASSERT_THAT(builder.lights(), SizeIs(1));
      const Light& light = builder.lights()[0];
      ASSERT_EQ(light.kind, LIGHT_RECTANGLE);
      // p0 with its neighbours p1, the next one, and p2, the previous one.
      const Exact3 u = exact(light.p1) - exact(light.p0), v = exact(light.p2) - exact(light.p0);
      EXPECT_LT(std::abs(dot(u, v)), 1e-5L * length(u) * length(v));
      const Exact3 normal = area_of(triangles);
      EXPECT_GT(dot(cross(u, v), normal), 0);
      EXPECT_NEAR(double(length(cross(u, v))), 6, 1e-5);
      EXPECT_NEAR(light.area, 6, 1e-5);
      std::set<Point> corners;
      for (const LightTriangle& t : triangles)
        for (const Point& p : vertices(t)) corners.insert(p);
      EXPECT_THAT(corners, ::testing::IsSupersetOf(vertices(light)));
    }
}

TEST(LightBuilder, WhatIsNoRectangleStaysTriangles) {
  const Triangles skew = parallelogram(flat(0, 0), flat(2, 0), flat(0.25f, 1)),
                  trapezoid{{flat(0, 0), flat(3, 0), flat(2, 1)}, {flat(0, 0), flat(2, 1), flat(0, 1)}},
                  ell = cells({"x.", "xx"}), one{{flat(0, 0), flat(1, 0), flat(0, 1)}};
  for (const Triangles& triangles : {skew, trapezoid, ell, one}) {
    LightBuilder builder(kSolidAngle, true);
    check(builder, triangles, builder.add_triangles(triangles, emitter()));
    EXPECT_THAT(builder.lights(), SizeIs(triangles.size()));
    EXPECT_THAT(builder.polygons(), SizeIs(1));
    for (const Light& light : builder.lights()) EXPECT_EQ(light.kind, LIGHT_TRIANGLE);
  }
}

TEST(LightBuilder, TwoSidesAreForFlatLights) {
  for (const bool two_sided : {false, true}) {
    const Shape shape = emitter(glm::vec3(1), kAuto, two_sided);
    LightBuilder builder(kAuto, true);
    builder.add_triangles(rectangle(), shape);
    Light quadric{};
    quadric.kind = LIGHT_DISK;
    builder.add_quadric(quadric, shape, 1);
    quadric.kind = LIGHT_SPHERE;
    builder.add_quadric(quadric, shape, 1);
    const int expected = two_sided ? 1 : 0;
    EXPECT_EQ(builder.polygons()[0].two_sided, expected);
    std::vector<int> flags;
    for (const Light& light : builder.lights()) flags.push_back(light.two_sided);
    EXPECT_THAT(flags, ElementsAre(expected, expected, 0));
  }
}

// --- what is odd

TEST(LightBuilder, DuplicatesShineOnceHoweverTheyAreSampled) {
  const Triangles once = rectangle();
  Triangles twice = together(once, once);
  twice.push_back({once[1].p1, once[1].p2, once[1].p0});  // from another corner on
  for (const bool polygons : {false, true})
    for (const EmitterSampling sampling : kSamplings) {
      const Shape shape = emitter(glm::vec3(1), sampling);
      LightBuilder builder(kAuto, polygons);
      const std::vector<int> index = builder.add_triangles(twice, shape);
      builder.finish();
      EXPECT_EQ(builder.duplicates(), 3);
      const LightBuilder expected = build(once, shape, polygons);
      EXPECT_THAT(builder.lights(), SizeIs(expected.lights().size()));
      EXPECT_THAT(builder.polygons(), SizeIs(polygons ? 1 : 0));
      ASSERT_THAT(index, SizeIs(5));
      EXPECT_EQ(index[2], index[0]);
      EXPECT_EQ(index[3], index[1]);
      EXPECT_EQ(index[4], index[1]);
      double area = 0, probability = 0;
      for (const Light& light : builder.lights()) {
        area += light.area;
        probability += light.pmf;
      }
      EXPECT_EQ(area, 6);
      EXPECT_NEAR(probability, 1, 4 * kFloat);
    }
}

TEST(LightBuilder, BackToBackTrianglesAreNoDuplicates) {
  for (const bool polygons : {false, true}) {
    const Triangles both = together(rectangle(), turned(rectangle()));
    LightBuilder builder(kAuto, polygons);
    check(builder, both, builder.add_triangles(both, emitter()));
    EXPECT_EQ(builder.duplicates(), 0);
    EXPECT_THAT(builder.lights(), SizeIs(2));
    EXPECT_THAT(builder.polygons(), SizeIs(polygons ? 2 : 0));
  }
}

TEST(LightBuilder, TrianglesWithoutAreaAreNeverChosen) {
  const vec3 p = flat(9, 9), q = flat(10, 9), r = flat(11, 9);
  const Triangles all = together(rectangle(), {{p, p, p}, {p, q, q}, {p, q, r}, {q, p, q}, {q, q, p}});
  for (const bool polygons : {false, true})
    for (const EmitterSampling sampling : kSamplings) {
      LightBuilder builder(sampling, polygons);
      const std::vector<int> index = builder.add_triangles(all, emitter());
      builder.finish();
      ASSERT_THAT(index, SizeIs(all.size()));
      for (const Light& light : builder.lights()) {
        EXPECT_TRUE(std::isfinite(light.pmf) && std::isfinite(light.area));
        EXPECT_EQ(light.pmf > 0, light.area > 0);
      }
      for (const int light : builder.cells()) {
        EXPECT_GT(builder.lights()[std::size_t(light)].pmf, 0);
      }
      if (polygons) {
        EXPECT_EQ(builder.polygons()[0].area, 6);
      }
    }
}

TEST(LightBuilder, NothingMakesNothing) {
  for (const bool polygons : {false, true}) {
    const LightBuilder builder = build({}, emitter(), polygons);
    EXPECT_THAT(builder.lights(), IsEmpty());
    EXPECT_THAT(builder.polygons(), IsEmpty());
    EXPECT_THAT(builder.corners(), IsEmpty());
    EXPECT_EQ(builder.features(), 0u);
  }
}

// --- among others

TEST(LightBuilder, OtherEmittersAreNoPolygons) {
  LightBuilder builder(kProjected, true);
  builder.add_triangles(rectangle(), emitter());
  EXPECT_TRUE(builder.only_polygons());
  Light quadric{};
  quadric.kind = LIGHT_SPHERE;
  builder.add_quadric(quadric, emitter(), 1);
  EXPECT_FALSE(builder.only_polygons());
  quadric.kind = LIGHT_DISK;
  builder.add_quadric(quadric, emitter(), 1);
  builder.add_emitter(PointLight{}, kPlace);
  builder.add_emitter(ConstantEnvironment{}, kPlace);
  builder.finish();
  EXPECT_THAT(builder.polygons(), SizeIs(1));
  std::vector<int> polygon_of;
  for (const Light& light : builder.lights()) polygon_of.push_back(light.polygon);
  EXPECT_THAT(polygon_of, ElementsAre(0, 0, -1, -1, -1, -1));
  EXPECT_EQ(builder.features(), std::uint64_t(FEATURE_POLYGONS | FEATURE_PROJECTED));
  EXPECT_EQ(builder.kinds(), 1u << LIGHT_TRIANGLE | 1u << LIGHT_SPHERE | 1u << LIGHT_DISK |
                                 1u << LIGHT_POINT | 1u << LIGHT_ENVIRONMENT);
}

TEST(LightBuilder, QuadricsAloneNeedNoPolygonsAndNoProjection) {
  LightBuilder builder(kProjected, true);
  Light quadric{};
  quadric.kind = LIGHT_SPHERE;
  builder.add_quadric(quadric, emitter(), 1);
  EXPECT_EQ(builder.features(), 0u);
}

TEST(LightBuilder, ChoosesByPower) {
  // Mean radiance times area; the second side is not counted, nor how a light is cut up.
  for (const EmitterSampling sampling : kSamplings) {
    LightBuilder builder(sampling, true);
    const std::vector<int> first = builder.add_triangles(rectangle(0, 3, 2), emitter(glm::vec3(1, 2, 3))),
                           second = builder.add_triangles(rectangle(0, 4, 1), emitter(glm::vec3(9, 0, 0)));
    builder.finish();
    double probability[2] = {0, 0};
    for (const Light& light : builder.lights()) probability[light.polygon] += light.pmf;
    EXPECT_NEAR(probability[0], 12.0 / 24, 4 * kFloat);
    EXPECT_NEAR(probability[1], 12.0 / 24, 4 * kFloat);
  }
}

TEST(LightBuilder, IsConstantIfProjectedAndOfOneColour) {
  const auto constant = [](const std::vector<std::pair<glm::vec3, EmitterSampling>>& shapes) {
    LightBuilder builder(kProjected, true);
    for (const auto& [radiance, sampling] : shapes)
      builder.add_triangles(rectangle(), emitter(radiance, sampling));
    return builder.constant_if_projected();
  };
  const glm::vec3 colour(1, 2, 3);
  EXPECT_TRUE(constant({{colour, kAuto}}));
  EXPECT_TRUE(constant({{colour, kAuto}, {4.0f * colour, kProjected}}));
  EXPECT_FALSE(constant({{colour, kArea}}));
  EXPECT_FALSE(constant({{colour, kAuto}, {colour, kSolidAngle}}));
  EXPECT_FALSE(constant({{colour, kAuto}, {glm::vec3(1, 2, 4), kAuto}}));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      glm::vec3 a(0), b(0);
      a[i] = b[j] = 2;
      EXPECT_EQ(constant({{a, kAuto}, {b, kAuto}}), i == j);
    }
  LightBuilder with_point(kProjected, true);
  with_point.add_triangles(rectangle(), emitter());
  with_point.add_emitter(PointLight{}, kPlace);
  EXPECT_FALSE(with_point.constant_if_projected());
  EXPECT_FALSE(build(rectangle(), emitter(), false, kProjected).constant_if_projected())
      << "no polygon without the closed form";
}

}  // namespace
}  // namespace penumbra
