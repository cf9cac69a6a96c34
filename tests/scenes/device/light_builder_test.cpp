// Emitters as tables of lights and polygons: kinds, order, areas, probabilities, and no more tables than
// needed.
#include "scenes/device/light_builder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "scenes/device/to_vec3.h"
#include "tests/kernels/exact_vector.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using enum EmitterSampling;

SceneRecords records;
const EmitterPlace kPlace{[](const glm::dvec3& p) { return to_vec3(p); }, 10, records};

constexpr EmitterSampling kSamplings[] = {kAuto, kArea, kSolidAngle, kProjected};
constexpr double kFloat = 1.0 / (1 << 24);  ///< half an ulp, relative

using Triangles = std::vector<LightTriangle>;
using Point = std::array<float, 3>;
Point point(const vec3& p) { return {p.x, p.y, p.z}; }
std::set<Point> vertices(const Light& light) { return {point(light.p0), point(light.p1), point(light.p2)}; }
std::set<Point> vertices(const LightTriangle& t) { return {point(t.p0), point(t.p1), point(t.p2)}; }

Shape emitter(glm::vec3 radiance = glm::vec3(1), EmitterSampling sampling = kAuto, bool two_sided = false) {
  Shape shape;
  shape.name = "emitter";
  shape.radiance = radiance;
  shape.sampling = sampling;
  shape.two_sided_emission = two_sided;
  return shape;
}

vec3 flat(float x, float y) { return make_vec3(x, y, 0); }

/// The parallelogram with three corners and p1 + p2 - p0, facing (p1 - p0) x (p2 - p0).
Triangles parallelogram(const vec3& p0, const vec3& p1, const vec3& p2) {
  const vec3 p3 = sub(add(p1, p2), p0);
  return {{p0, p1, p3}, {p0, p3, p2}};
}
Triangles rectangle(float x = 0, float width = 3, float height = 2) {
  return parallelogram(flat(x, 0), flat(x + width, 0), flat(x, height));
}

/// Cells of a grid of 1 x 1 cells where the mask has an 'x', its first row the uppermost one.
Triangles cells(const std::vector<const char*>& mask, const std::function<vec3(float, float)>& place = flat) {
  Triangles out;
  for (std::size_t j = 0; j < mask.size(); ++j)
    for (std::size_t i = 0; mask[j][i] != 0; ++i) {
      if (mask[j][i] != 'x') continue;
      const auto x = float(i), y = float(mask.size() - 1 - j);
      const vec3 a = place(x, y), b = place(x + 1, y), c = place(x + 1, y + 1), d = place(x, y + 1);
      out.insert(out.end(), {{a, b, c}, {a, c, d}});
    }
  return out;
}

Triangles turned(Triangles triangles) {
  for (LightTriangle& t : triangles) std::swap(t.p1, t.p2);
  return triangles;
}

Triangles together(Triangles a, const Triangles& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Tilted: nothing about it is along an axis, and all of its points are rounded.
vec3 tilted(float x, float y) {
  const Exact3 u = normalize(Exact3{2, 1, -1}), v = normalize(cross(Exact3{1, -1, 1}, u));
  return rounded(Exact3{-4, 3, 7} + (long double)x * u + (long double)y * v);
}

LightBuilder build(const Triangles& triangles, const Shape& shape, bool polygons,
                   EmitterSampling by_default = kAuto) {
  LightBuilder builder(by_default, polygons);
  builder.add_triangles(triangles, shape);
  builder.finish();
  return builder;
}

/// Half the sum of the cross products of consecutive corners: the shoelace formula in space. Its length is
/// the area that the loops enclose, and it points to where the front faces.
Exact3 enclosed(const LightBuilder& builder, const Polygon& polygon) {
  Exact3 sum;
  for (int k = 1; k < polygon.corner_count; ++k) {
    const PolygonCorner& to = builder.corners()[std::size_t(polygon.first_corner + k)];
    const PolygonCorner& from = builder.corners()[std::size_t(polygon.first_corner + k - 1)];
    const Exact3 middle = exact(builder.corners()[std::size_t(polygon.first_corner)].p);
    if (to.starts == 0) sum = sum + 0.5L * cross(exact(from.p) - middle, exact(to.p) - middle);
  }
  return sum;
}

Exact3 area_of(const Triangles& triangles) {
  Exact3 sum;
  for (const LightTriangle& t : triangles)
    sum = sum + 0.5L * cross(exact(t.p1) - exact(t.p0), exact(t.p2) - exact(t.p0));
  return sum;
}

std::vector<std::vector<vec3>> loops_of(const LightBuilder& builder, const Polygon& polygon) {
  std::vector<std::vector<vec3>> loops;
  for (int k = 0; k < polygon.corner_count; ++k) {
    const PolygonCorner& corner = builder.corners()[std::size_t(polygon.first_corner + k)];
    if (corner.starts != 0) loops.emplace_back();
    loops.back().push_back(corner.p);
  }
  return loops;
}

/// What holds for every result.
void check(const LightBuilder& builder, const Triangles& triangles, const std::vector<int>& index) {
  ASSERT_THAT(index, SizeIs(triangles.size()));
  int next_light = 0, next_corner = 0;
  for (std::size_t k = 0; k < builder.polygons().size(); ++k) {
    const Polygon& polygon = builder.polygons()[k];
    EXPECT_EQ(polygon.first_light, next_light);
    EXPECT_EQ(polygon.first_corner, next_corner);
    ASSERT_GE(polygon.light_count, 1);
    ASSERT_GE(polygon.corner_count, 4);
    next_light += polygon.light_count;
    next_corner += polygon.corner_count;
    double parts = 0;
    for (int i = 0; i < polygon.light_count; ++i) {
      const Light& light = builder.lights().at(std::size_t(polygon.first_light + i));
      EXPECT_EQ(light.polygon, int(k));
      EXPECT_EQ(light.two_sided, polygon.two_sided);
      EXPECT_EQ(point(light.radiance), point(polygon.radiance));
      parts += light.area;
    }
    EXPECT_NEAR(parts, polygon.area, (polygon.light_count + 1) * kFloat * polygon.area);
    float widest = 0;
    ASSERT_EQ(builder.corners().at(std::size_t(polygon.first_corner)).starts, 1);
    for (const std::vector<vec3>& loop : loops_of(builder, polygon)) {
      ASSERT_GE(loop.size(), 4u);
      EXPECT_EQ(point(loop.front()), point(loop.back())) << "a loop ends where it starts";
      for (const vec3& a : loop)
        for (const vec3& b : loop) widest = std::max(widest, length3(sub(a, b)));
    }
    EXPECT_GE(polygon.size, widest);
    EXPECT_LE(polygon.size, 2 * widest);
  }
  if (!builder.polygons().empty()) {
    EXPECT_EQ(next_light, int(builder.lights().size()));
    EXPECT_EQ(next_corner, int(builder.corners().size()));
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    ASSERT_GE(index[t], 0);
    ASSERT_LT(index[t], int(builder.lights().size()));
    const Light& light = builder.lights()[std::size_t(index[t])];
    if (light.kind == LIGHT_TRIANGLE) {
      EXPECT_EQ(vertices(light), vertices(triangles[t]));
    }
  }
}

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
      EXPECT_EQ(builder.features(), code == EMITTER_SOLID_ANGLE ? unsigned(FEATURE_SOLID_ANGLE)
                                    : code == EMITTER_PROJECTED ? unsigned(FEATURE_PROJECTED)
                                                                : 0u);
    }
}

TEST(LightBuilder, ARectangleIsOneLightOnlyWhereSampledBySolidAngle) {
  for (const bool polygons : {false, true})
    for (const EmitterSampling sampling : kSamplings) {
      LightBuilder builder(kAuto, polygons);
      const Triangles triangles = rectangle();
      const std::vector<int> index = builder.add_triangles(triangles, emitter(glm::vec3(1), sampling));
      check(builder, triangles, index);
      EXPECT_THAT(builder.polygons(), SizeIs(polygons ? 1 : 0));
      EXPECT_EQ((builder.features() & FEATURE_POLYGONS) != 0, polygons);
      for (const Light& light : builder.lights()) EXPECT_EQ(light.polygon, polygons ? 0 : -1);
      if (sampling == kSolidAngle) {
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
    EXPECT_THAT(flags, ElementsAre(expected, expected, expected, 0));
  }
}

// --- polygons

TEST(LightBuilder, ComponentsAreSeparatePolygons) {
  // Three islands in one plane, two of which touch in a corner, and one in another plane.
  const Triangles island = cells({"xx"}), other = cells({"xx..x", "x..x."}, tilted);
  const Triangles all = together(island, other);
  LightBuilder builder(kAuto, true);
  const std::vector<int> index = builder.add_triangles(all, emitter());
  check(builder, all, index);
  double area = 0;
  for (const Polygon& polygon : builder.polygons()) area += polygon.area;
  EXPECT_NEAR(area, 7, 1e-5);
  // Figures that touch in a corner may be one polygon of two loops or two polygons, but no two share edges.
  std::size_t loops = 0;
  for (const Polygon& polygon : builder.polygons()) loops += loops_of(builder, polygon).size();
  EXPECT_EQ(loops, 4u);
  EXPECT_NE(builder.lights()[std::size_t(index[0])].polygon, builder.lights()[std::size_t(index[4])].polygon);
}

TEST(LightBuilder, LaterShapesGetLaterPolygons) {
  LightBuilder builder(kProjected, true);
  const Triangles first = rectangle(0), second = rectangle(3);  // side by side, but not of one shape
  EXPECT_THAT(builder.add_triangles(first, emitter(glm::vec3(1, 2, 3))), ElementsAre(0, 1));
  EXPECT_THAT(builder.add_triangles(second, emitter(glm::vec3(4, 5, 6), kSolidAngle)), ElementsAre(2, 2));
  ASSERT_THAT(builder.polygons(), SizeIs(2));
  EXPECT_EQ(builder.polygons()[1].radiance.x, 4);
  EXPECT_EQ(builder.polygons()[1].first_light, 2);
  EXPECT_EQ(builder.polygons()[1].light_count, 1);
  EXPECT_EQ(builder.polygons()[1].first_corner, 5);
  EXPECT_EQ(builder.lights()[2].polygon, 1);
  EXPECT_EQ(builder.features(), unsigned(FEATURE_POLYGONS | FEATURE_PROJECTED | FEATURE_SOLID_ANGLE));
}

struct Figure {
  std::vector<const char*> mask;
  std::vector<int> corners;  ///< of its loops, the longest first
};
const Figure kFigures[] = {{{"x"}, {4}},
                           {{"xxx", "xxx"}, {4}},
                           {{"x.", "xx"}, {6}},
                           {{"x.x.x", "xxxxx"}, {12}},                // a comb
                           {{"xxxx", "x..x", "x.xx", "x..."}, {10}},  // a hook
                           {{"xxx", "x.x", "xxx"}, {4, 4}},           // a hole
                           {{"xxxxx", "x.x.x", "xxxxx"}, {4, 4, 4}},  // two
                           {{".x..", "xxxx", ".xx."}, {12}}};

TEST(LightBuilder, OutlinesEncloseTheirMeshInOrder) {
  for (const auto& place :
       {std::function<vec3(float, float)>(flat), std::function<vec3(float, float)>(tilted)})
    for (const bool back : {false, true})
      for (const Figure& figure : kFigures) {
        Triangles triangles = cells(figure.mask, place);
        if (back) triangles = turned(triangles);
        LightBuilder builder(kAuto, true);
        check(builder, triangles, builder.add_triangles(triangles, emitter()));
        ASSERT_THAT(builder.polygons(), SizeIs(1));
        const Polygon& polygon = builder.polygons()[0];
        // Coordinates up to 16 round by 2^-21; that moves each edge, at most 12 of length up to 5.
        constexpr double kRounding = 12 * 5 * 16 * kFloat;
        const Exact3 inside = enclosed(builder, polygon), meshes = area_of(triangles);
        EXPECT_LT(double(length(inside - meshes)), kRounding);
        EXPECT_NEAR(double(length(inside)), double(triangles.size()) / 2, kRounding);
        EXPECT_NEAR(polygon.area, double(triangles.size()) / 2, kRounding);
        std::vector<int> counts;
        for (const auto& loop : loops_of(builder, polygon)) counts.push_back(int(loop.size()) - 1);
        std::ranges::sort(counts, std::greater());
        EXPECT_EQ(counts, figure.corners) << figure.mask[0];
      }
}

TEST(LightBuilder, AConcaveOutlineIsItsCornersCounterclockwise) {
  const LightBuilder builder = build(cells({"x.", "xx"}), emitter(), true);
  std::vector<Point> loop;
  for (const PolygonCorner& corner : builder.corners()) loop.push_back(point(corner.p));
  loop.pop_back();
  std::ranges::rotate(loop, std::ranges::find(loop, Point{0, 0, 0}));
  EXPECT_THAT(loop, ElementsAre(Point{0, 0, 0}, Point{2, 0, 0}, Point{2, 1, 0}, Point{1, 1, 0},
                                Point{1, 2, 0}, Point{0, 2, 0}));
}

TEST(LightBuilder, CurvedMeshesHaveAPolygonForEachFace) {
  const vec3 a = make_vec3(0, 0, 0), b = make_vec3(1, 0, 0), c = make_vec3(0, 1, 0), d = make_vec3(0, 0, 1);
  const Triangles tetrahedron{{a, c, b}, {a, b, d}, {a, d, c}, {b, c, d}};
  LightBuilder builder(kAuto, true);
  const std::vector<int> index = builder.add_triangles(tetrahedron, emitter());
  check(builder, tetrahedron, index);
  EXPECT_THAT(builder.polygons(), SizeIs(4));
  EXPECT_THAT(index, ElementsAre(0, 1, 2, 3));
  for (const Polygon& polygon : builder.polygons()) EXPECT_EQ(polygon.corner_count, 4);
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
    EXPECT_THAT(builder.lights(), SizeIs(4));
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
        EXPECT_GT(builder.lights()[std::size_t(light.alias)].pmf, 0);
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
  EXPECT_EQ(builder.features(), unsigned(FEATURE_POLYGONS | FEATURE_PROJECTED));
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
