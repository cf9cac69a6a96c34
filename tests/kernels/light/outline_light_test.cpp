// Flat lights of several triangles, as one light: its points are uniform over the triangles, its samples'
// densities are those of what rays find, shadow rays end before the triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "scenes/device/light_strips.h"
#include "tests/kernels/light_scenes.h"
#include "tests/kernels/random_numbers.h"
#include "tests/scenes/device/light_builder_pieces.h"
#include "tests/support/statistics.h"

namespace penumbra::outline_light_test {
namespace {

constexpr double kSignificance = 0.01;

using Place = std::function<vec3(double, double)>;

/// A figure of triangles in a plane: of the corners, counter-clockwise.
struct Figure {
  std::string name;
  std::vector<std::array<double, 2>> corners;
  std::vector<std::array<int, 3>> triangles;

  [[nodiscard]] Triangles at(const Place& place) const {
    Triangles all;
    const auto corner = [&](int k) { return place(corners[std::size_t(k)][0], corners[std::size_t(k)][1]); };
    for (const auto& [a, b, c] : triangles) all.push_back({corner(a), corner(b), corner(c)});
    return all;
  }
};

void PrintTo(const Figure& figure, std::ostream* out) { *out << figure.name; }

/// Corners about a centre, at radii in turn.
Figure star(const std::string& name, int points, const std::vector<double>& radii) {
  Figure figure{name, {{0, 0}}, {}};
  for (int k = 0; k < points; ++k) {
    const double angle = 2 * std::numbers::pi * k / points, radius = radii[std::size_t(k) % radii.size()];
    figure.corners.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    figure.triangles.push_back({0, 1 + k, 1 + (k + 1) % points});
  }
  return figure;
}

/// A square ring, of different widths.
Figure ring() {
  return {"Ring",
          {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-0.5, -0.2}, {0.8, -0.6}, {0.7, 0.4}, {-0.6, 0.7}},
          {{0, 1, 4}, {1, 5, 4}, {1, 2, 5}, {2, 6, 5}, {2, 3, 6}, {3, 7, 6}, {3, 0, 7}, {0, 4, 7}}};
}

const Figure kFigures[] = {
    {"Trapezoid", {{-1, 0}, {1, 0}, {0.3, 0.7}, {-0.4, 0.7}}, {{0, 1, 2}, {0, 2, 3}}},
    {"Parallelogram", {{-1, -0.5}, {0.5, -0.5}, {1, 0.5}, {-0.5, 0.5}}, {{0, 1, 2}, {0, 2, 3}}},
    {"Quadrilateral", {{-1, -0.8}, {0.9, -0.5}, {0.4, 0.6}, {-0.3, 0.5}}, {{0, 1, 2}, {0, 2, 3}}},
    {"Chevron", {{0, -0.2}, {1, -1}, {0, 1}, {-1, -1}}, {{0, 1, 2}, {0, 2, 3}}},
    {"Sliver", {{0, 0}, {1, 0}, {1, 0.01}, {-0.5, 0.01}}, {{0, 1, 2}, {0, 2, 3}}},
    star("Star", 10, {1, 0.4}),
    star("Blob", 31, {1, 0.7, 0.9, 0.4, 0.5, 0.8, 0.6}),
    star("ManyCorners", 60, {1, 0.997}),
    ring(),
};

class OutlineLights : public testing::TestWithParam<Figure> {};
INSTANTIATE_TEST_SUITE_P(All, OutlineLights, testing::ValuesIn(kFigures),
                         [](const auto& tested) { return tested.param.name; });

/// A plane about `center` that faces the origin more or less.
Place random_plane(RandomNumbers& random, const Exact3& center, double bend = 0) {
  const Exact3 n = normalize(random.direction() - 1.5L * normalize(center));
  const Exact3 x = normalize(cross(n, random.direction())), y = cross(n, x);
  return [=](double u, double v) {
    return rounded(center + (long double)u * x + (long double)v * y + (long double)(bend * u * v) * n);
  };
}

/// The scene that the light builder makes of it; nothing but the light.
SceneTables area_light_scene(const Triangles& triangles) {
  LightBuilder builder(EmitterSampling::kAuto, false);
  const std::vector<int> index =
      builder.add_triangles(triangles, emitter(glm::vec3(1, 2, 3), EmitterSampling::kArea));
  builder.finish();
  SceneTables tables;
  tables.header.environment = -1;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    tables.add_triangle(triangles[k].p0, triangles[k].p1, triangles[k].p2);
    tables.triangles.back().light = index[k];
  }
  tables.lights = builder.lights();
  tables.light_strips = builder.strips();
  tables.light_cells = builder.cells();
  return tables;
}

TEST_P(OutlineLights, AreOneLight) {
  RandomNumbers random(1);
  for (int k = 0; k < 20; ++k) {
    const Triangles triangles = GetParam().at(random_plane(random, 3.0L * random.direction()));
    const SceneTables tables = area_light_scene(triangles);
    ASSERT_EQ(tables.lights.size(), 1u);
    EXPECT_EQ(tables.lights[0].kind, LIGHT_OUTLINE);
    EXPECT_NEAR(tables.lights[0].area / double(length(area_of(triangles))), 1, 1e-6);
    EXPECT_EQ(tables.light_strips.front().start, 0);
    for (const Triangle& t : tables.triangles) EXPECT_EQ(t.light, 0);
  }
}

/// Which of four equal parts of the triangle p is in, its coordinates least outside of the triangle by `out`.
int part_of(const LightTriangle& t, const vec3& p, double& out) {
  const Exact3 a = exact(t.p0), n = cross(exact(t.p1) - a, exact(t.p2) - a);
  const auto share = [&](const vec3& from, const vec3& to) {
    return double(dot(cross(exact(to) - exact(from), exact(p) - exact(from)), n) / dot(n, n));
  };
  const double b0 = share(t.p1, t.p2), b1 = share(t.p2, t.p0), b2 = share(t.p0, t.p1);
  out = std::max(0.0, -std::min({b0, b1, b2}));
  return b0 > 0.5 ? 0 : b1 > 0.5 ? 1 : b2 > 0.5 ? 2 : 3;
}

TEST_P(OutlineLights, PointsAreUniformOverTheTriangles) {
  RandomNumbers random(2);
  const Triangles triangles = GetParam().at(random_plane(random, 3.0L * random.direction()));
  SceneTables tables = area_light_scene(triangles);
  const Scene scene = tables.scene();
  const LightReceiver from = receiver_of(receiver(make_vec3(0, 0, 0), make_vec3(0, 0, 1)));
  constexpr int kPoints = 200'000;
  std::vector<double> counts(4 * triangles.size()), expected(counts.size());
  const auto area = [](const Triangles& of) { return double(length(area_of(of))); };
  for (std::size_t k = 0; k < expected.size(); ++k)
    expected[k] = kPoints * area({triangles[k / 4]}) / (4 * area(triangles));
  for (int i = 0; i < kPoints; ++i) {
    const float u = random.unit_float(), v = random.unit_float();
    const SampledPoint point = sample_outline_point(&scene, 0, from, u, v, 0u);
    double least = 1e300;
    std::size_t cell = 0;
    for (std::size_t t = 0; t < triangles.size() && least > 0; ++t) {
      double out = 0;
      const int part = part_of(triangles[t], point.at.p, out);
      if (out >= least) continue;
      least = out;
      cell = 4 * t + std::size_t(part);
    }
    // Four roundings of coordinates up to 4, as a share of the sliver's width of 0.01.
    ASSERT_LT(least, 4 * 4 * 0x1p-24 / 0.01) << u << " " << v;
    ++counts[cell];
  }
  EXPECT_GT(statistics::chi_square_test(counts, expected).p, kSignificance / double(std::size(kFigures)));
}

TEST_P(OutlineLights, InverseDensitiesAverageToTheSolidAngle) {
  RandomNumbers random(3);
  for (int k = 0; k < 4; ++k) {
    const Triangles triangles = GetParam().at(random_plane(random, (1.2L + k) * random.direction()));
    double expected = 0;
    for (const LightTriangle& t : triangles)
      expected += exact_solid_angle(exact(t.p0), exact(t.p1), exact(t.p2));
    SceneTables tables = area_light_scene(triangles);
    const Scene scene = tables.scene();
    const Surface s = receiver(make_vec3(0, 0, 0), make_vec3(0, 0, 1));
    statistics::Sample inverse;
    for (int i = 0; i < 50'000; ++i) {
      const float u = random.unit_float(), v = random.unit_float();
      const LightSample light = sample_light(scene, s, u, v, random.unit_float());
      ASSERT_GT(light.tmax, 0);
      ASSERT_EQ(light.radiance.y, 2);
      inverse.add(1 / double(light.pdf));
    }
    EXPECT_GT(statistics::t_test(inverse, expected, 1e-5 * expected).p,
              kSignificance / (4 * double(std::size(kFigures))))
        << inverse.mean() << " for " << expected;
  }
}

TEST_P(OutlineLights, ShadowRaysEndBeforeTheTrianglesAndRaysFindTheSameDensity) {
  RandomNumbers random(4);
  int found = 0;
  for (const double offset : {0.0, 10.0, 1e3})
    for (const double bend : {0.0, 5e-6})  // what still passes for a plane
      for (int k = 0; k < 60; ++k) {
        const vec3 shift = rounded(offset * random.direction());
        const Triangles triangles = GetParam().at(
            random_plane(random, exact(shift) + (1.5L + random.uniform()) * random.direction(), bend));
        SceneTables tables = area_light_scene(triangles);
        const Scene scene = tables.scene();
        const Surface s = receiver(shift, rounded(random.direction()));
        for (int i = 0; i < 50; ++i) {
          const float u = random.unit_float(), v = random.unit_float();
          const LightSample light = sample_light(scene, s, u, v, random.unit_float());
          if (!(light.tmax > 0)) continue;
          const auto trace = [&](float tmax) {
            return trace_one_by_one(tables, std::vector{TestRay{light.origin, light.wi, tmax}})[0];
          };
          const TestHit hit = trace(NO_LIMIT);
          if (hit.primitive < 0) continue;  // at its rim
          const Surface there = surface_at(&scene, hit.primitive, light.origin, light.wi);
          const float cosine = dot3(there.geometric, there.wo);
          // Nearly edge-on the light's own rounding decides which side is seen.
          const double off = 64 * 0x1p-24 * (offset + 4) + 2 * bend;
          if (cosine < 0.05 + 100 * off) continue;
          ASSERT_EQ(trace(light.tmax).primitive, -1) << "offset " << offset << " bend " << bend;
          ASSERT_NEAR(light.pdf / emission_at(scene, there).pdf, 1, 1e-4 + 20 * off / cosine);
          ++found;
        }
      }
  EXPECT_GT(found, 3000);
}

Outline outline_of(const std::vector<std::vector<vec3>>& loops, double area) {
  Outline outline;
  outline.loops = loops;
  outline.area = area;
  outline.normal = {0, 0, 1};
  return outline;
}
std::vector<vec3> square(float low, float high) {
  return {make_vec3(low, low, 0), make_vec3(high, low, 0), make_vec3(high, high, 0), make_vec3(low, high, 0)};
}

TEST(LightStrips, AreFewestAlongAnEdge) {
  EXPECT_EQ(strips_of(outline_of({square(0, 1)}, 1))->strips.size(), 1u);
  // Along its slanting sides it would have three.
  const std::vector<vec3> trapezoid{make_vec3(0, 0, 0), make_vec3(1, 0, 0), make_vec3(0.9f, 3, 0),
                                    make_vec3(0.3f, 3, 0)};
  EXPECT_EQ(strips_of(outline_of({trapezoid}, 2.4))->strips.size(), 1u);
}

TEST(LightStrips, AreNoneOfWhatIsNoFigure) {
  EXPECT_TRUE(strips_of(outline_of({square(0, 2)}, 4)));
  EXPECT_FALSE(strips_of(outline_of({square(0, 2)}, 0))) << "without an area";
  EXPECT_FALSE(strips_of(outline_of({square(0, 2)}, 4.001))) << "not that area";
  EXPECT_FALSE(strips_of(outline_of({square(0, 2), square(1, 3)}, 8))) << "loops that overlap";
  EXPECT_FALSE(strips_of(outline_of({square(0, 2), square(0, 2)}, 8))) << "the same twice";
  std::vector<vec3> circle;
  for (int k = 0; k <= MOST_LIGHT_STRIPS; ++k) {
    const double angle = 2 * std::numbers::pi * k / (MOST_LIGHT_STRIPS + 1);
    circle.push_back(make_vec3(float(std::cos(angle)), float(std::sin(angle)), 0));
  }
  EXPECT_FALSE(strips_of(outline_of({circle}, 3.13670))) << "more corners than strips";
}

}  // namespace
}  // namespace penumbra::outline_light_test
