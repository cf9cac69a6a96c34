#include "scenes/polygon_triangulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "scenes/transform.h"

namespace penumbra::polygon_triangulation_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

using Outline = std::vector<glm::dvec2>;
using Corners = std::vector<glm::dvec3>;

/// Shoelace formula, positive counterclockwise.
double area(const Outline& outline) {
  double sum = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec2 a = outline[i], b = outline[(i + 1) % outline.size()];
    sum += a.x * b.y - a.y * b.x;
  }
  return 0.5 * sum;
}

/// By the crossings of a ray along +x.
bool is_inside(const Outline& outline, glm::dvec2 p) {
  bool inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec2 a = outline[i], b = outline[(i + 1) % outline.size()];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside;
}

/// The outline in a plane of space.
Corners placed(const Outline& outline, const glm::dmat4& to_world = glm::dmat4(1.0)) {
  Corners corners;
  for (const glm::dvec2 p : outline) corners.push_back(transform_point(to_world, {p, 0.0}));
  return corners;
}

Triangulation cut(const Corners& corners) {
  const auto result = triangulate(corners);
  EXPECT_TRUE(result) << result.error().message;
  return result ? *result : Triangulation{};
}

/// Relative, of areas that are sums of a few hundred products of doubles.
constexpr double kAreaTolerance = 1e-12;

/// The triangles are all inside the outline, none over another (their areas add up to the outline's), turn
/// the way that it turns, have area, and leave no corner out.
void expect_exact(const Outline& outline, std::size_t triangles) {
  const Triangulation result = cut(placed(outline));
  EXPECT_FALSE(result.tangled);
  EXPECT_EQ(result.deviation, 0.0);
  ASSERT_THAT(result.triangles, SizeIs(triangles));
  const double whole = area(outline), sign = whole > 0.0 ? 1.0 : -1.0;
  double sum = 0.0;
  std::set<unsigned> used;
  for (const glm::uvec3& t : result.triangles) {
    const Outline triangle = {outline[t.x], outline[t.y], outline[t.z]};
    EXPECT_GT(sign * area(triangle), 0.0) << t.x << " " << t.y << " " << t.z;
    sum += area(triangle);
    used.insert({t.x, t.y, t.z});
    // Points close to the triangle's corners and edges, and its middle.
    for (const glm::dvec3 w : {glm::dvec3(1, 1, 1), glm::dvec3(98, 1, 1), glm::dvec3(1, 98, 1),
                               glm::dvec3(1, 1, 98), glm::dvec3(49, 49, 2), glm::dvec3(2, 49, 49)}) {
      const glm::dvec2 p = (w.x * triangle[0] + w.y * triangle[1] + w.z * triangle[2]) / (w.x + w.y + w.z);
      EXPECT_TRUE(is_inside(outline, p)) << p.x << " " << p.y;
    }
  }
  EXPECT_NEAR(sum, whole, kAreaTolerance * std::abs(whole));
  EXPECT_THAT(used, SizeIs(outline.size()));
}

Outline reversed(Outline outline) {
  std::ranges::reverse(outline);
  return outline;
}

/// Radii at equal angles.
Outline star(const std::vector<double>& radii) {
  Outline outline;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const double angle = 2.0 * std::numbers::pi * double(i) / double(radii.size());
    outline.push_back(radii[i] * glm::dvec2(std::cos(angle), std::sin(angle)));
  }
  return outline;
}

/// Teeth of a comb, open to the top.
Outline comb(int teeth) {
  Outline outline = {{0.0, -1.0}, {double(teeth), -1.0}};
  for (int i = teeth; i-- > 0;) {
    outline.insert(outline.end(), {{i + 0.9, 10.0}, {i + 0.6, 10.0}, {i + 0.5, 0.0}, {i + 0.1, 0.0}});
  }
  return outline;
}

/// A corridor of width 0.5 that winds in, its walls a polygon.
Outline spiral(int corners) {
  Outline outer, inner;
  for (int i = 0; i < corners; ++i) {
    const double angle = 0.5 * i, radius = 1.0 + angle / (2.0 * std::numbers::pi);
    outer.push_back((radius + 0.5) * glm::dvec2(std::cos(angle), std::sin(angle)));
    inner.push_back(radius * glm::dvec2(std::cos(angle), std::sin(angle)));
  }
  std::ranges::reverse(inner);
  outer.insert(outer.end(), inner.begin(), inner.end());
  return outer;
}

TEST(Triangulation, ConvexPolygonsAreFans) {
  const Outline hexagon = star(std::vector<double>(6, 2.0));
  EXPECT_THAT(cut(placed(hexagon)).triangles, ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3),
                                                          glm::uvec3(0, 3, 4), glm::uvec3(0, 4, 5)));
  expect_exact(hexagon, 4);
  expect_exact(reversed(hexagon), 4);
  EXPECT_THAT(cut({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}).triangles, ElementsAre(glm::uvec3(0, 1, 2)));
}

TEST(Triangulation, ConcaveStarsCombsAndSpirals) {
  std::vector<double> radii;
  for (int i = 0; i < 10; ++i) radii.push_back(i % 2 == 0 ? 1.5 : 0.6);
  const Outline ten = star(radii);
  // The closed form of a star: 10 triangles between neighbouring radii, 36 degrees apart.
  EXPECT_NEAR(area(ten), 5.0 * 1.5 * 0.6 * std::sin(std::numbers::pi / 5.0), 1e-14);
  for (const Outline& outline : {ten, comb(25), spiral(60), Outline{{0, 0}, {4, 0}, {1, 1}, {0, 4}}}) {
    expect_exact(outline, outline.size() - 2);
    expect_exact(reversed(outline), outline.size() - 2);
    Outline turned = outline;  // another first corner
    std::rotate(turned.begin(), turned.begin() + 3, turned.end());
    expect_exact(turned, turned.size() - 2);
  }
}

TEST(Triangulation, RandomOutlines) {
  std::mt19937 random(20250117);
  std::uniform_real_distribution<double> radius(0.05, 1.0);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    std::vector<double> radii(4 + random() % 60);
    std::ranges::generate(radii, [&] { return radius(random); });
    const Outline outline = star(radii);
    expect_exact(i % 2 == 0 ? outline : reversed(outline), outline.size() - 2);
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(Triangulation, AnyPlaneScaleAndPlaceGivesTheSame) {
  const Outline outline = comb(8);
  const auto expected = cut(placed(outline)).triangles;
  for (const glm::dmat4& m :
       {rotation({1, 2, 3}, 77), rotation({-3, 1, 0}, 160) * scaling({1e-6, 1e-6, 1e-6}),
        translation({1e5, -3e4, 2e5}) * rotation({0, 1, 0}, 90), scaling({1e9, 1e9, 1}),
        rotation({1, 0, 0}, 90), rotation({0, 1, 0}, -90)}) {
    const Triangulation result = cut(placed(outline, m));
    EXPECT_EQ(result.triangles, expected);
    EXPECT_FALSE(result.tangled);
    EXPECT_LT(result.deviation, 1e-9);  // 1e5 times the rounding of doubles, and room
  }
}

TEST(Triangulation, CornersOnStraightEdgesBelongToTrianglesWithArea) {
  expect_exact({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}, 6);
  expect_exact({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {0, 3}}, 3);
  expect_exact({{3, 0}, {0, 3}, {0, 0}, {1, 0}, {2, 0}}, 3);
  // Thirds, which no double is: on the edge but for rounding.
  Outline thirds = {{0, 0}};
  for (int i = 1; i < 3; ++i) thirds.emplace_back(i / 3.0, 0.7 * i / 3.0);
  thirds.insert(thirds.end(), {{1.0, 0.7}, {0.2, 0.9}});
  expect_exact(thirds, 3);
}

TEST(Triangulation, ACornerTwiceInARowIsOne) {
  const Triangulation square = cut({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}});
  EXPECT_THAT(square.triangles, ElementsAre(glm::uvec3(0, 1, 3), glm::uvec3(0, 3, 4)));
  EXPECT_FALSE(square.tangled);
}

TEST(Triangulation, OutlinesMayTouchThemselves) {
  // A square with a square hole, and a bridge to it that is walked twice.
  const Outline ring = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}};
  const Triangulation result = cut(placed(ring));
  EXPECT_FALSE(result.tangled);
  double sum = 0.0;
  for (const glm::uvec3& t : result.triangles) {
    const Outline triangle = {ring[t.x], ring[t.y], ring[t.z]};
    EXPECT_GT(area(triangle), 0.0);
    sum += area(triangle);
    const glm::dvec2 middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
    EXPECT_FALSE(middle.x > 1 && middle.x < 3 && middle.y > 1 && middle.y < 3) << "in the hole";
  }
  EXPECT_DOUBLE_EQ(sum, 12.0);
  // A notch whose tip lies on the opposite edge.
  const Triangulation notch = cut(placed({{0, 0}, {4, 0}, {4, 2}, {2, 0}, {0, 2}}));
  EXPECT_FALSE(notch.tangled);
  EXPECT_THAT(notch.triangles, SizeIs(2));
}

TEST(Triangulation, TangledOutlines) {
  const Corners bow = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_TRUE(cut(bow).tangled);
  EXPECT_THAT(cut(bow).triangles, ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3)));
  EXPECT_TRUE(cut({{0, 0, 0}, {3, 3, 0}, {3, 0, 0}, {0, 1, 0}}).tangled) << "a bow whose wings differ";
  EXPECT_TRUE(cut({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {3, 1, 0}}).tangled);
  EXPECT_TRUE(cut({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}).tangled) << "twice";
  EXPECT_TRUE(cut({{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {0, 1, 0}}).tangled) << "a spike";
  // A pentagram: its five edges cross each other, and it turns twice.
  Corners pentagram;
  for (int i = 0; i < 5; ++i)
    pentagram.emplace_back(std::cos(0.8 * i * std::numbers::pi), std::sin(0.8 * i * std::numbers::pi), 0.0);
  EXPECT_TRUE(cut(pentagram).tangled);
}

TEST(Triangulation, WithoutAreaItIsAFanThatCanBeLeftOut) {
  for (const Corners& flat : {Corners{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, Corners(5, {1, 2, 3}),
                              Corners{{0, 0, 0}, {1, 1, 1}, {0, 0, 0}, {1, 1, 1}}}) {
    const Triangulation result = cut(flat);
    EXPECT_THAT(result.triangles, SizeIs(flat.size() - 2));
    EXPECT_FALSE(result.tangled);
  }
}

TEST(Triangulation, DeviationFromThePlane) {
  // The mean plane of a saddle of height h is at half of it.
  constexpr double kHeight = 0.01;
  EXPECT_NEAR(cut({{0, 0, 0}, {1, 0, kHeight}, {1, 1, 0}, {0, 1, kHeight}}).deviation, 0.5 * kHeight, 1e-15);
  EXPECT_NEAR(cut({{0, 0, 0}, {500, 0, 5}, {500, 500, 0}, {0, 500, 5}}).deviation, 0.5 * kHeight, 1e-15);
  EXPECT_LT(cut({{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}).deviation, 1e-15);
}

TEST(Triangulation, LargeFaces) {
  const Outline many = comb(1000);
  EXPECT_THAT(cut(placed(many)).triangles, SizeIs(many.size() - 2));
  const auto too_many = triangulate(placed(comb(int(kMaxConcaveCorners) / 4)));
  ASSERT_FALSE(too_many);
  EXPECT_THAT(too_many.error().message, HasSubstr("a face of 16386 corners that is not convex"));
  EXPECT_THAT(cut(placed(star(std::vector<double>(kMaxConcaveCorners + 2, 1.0)))).triangles,
              SizeIs(kMaxConcaveCorners));
}

TEST(Triangulation, ExtremeNumbersDoNotFail) {
  for (const double scale : {1e-320, 1e-200, 1e200, 1e308}) {
    Corners corners = placed(comb(2));
    for (glm::dvec3& c : corners) c *= scale / 10.0;
    EXPECT_THAT(cut(corners).triangles, SizeIs(corners.size() - 2)) << scale;
  }
}

}  // namespace
}  // namespace penumbra::polygon_triangulation_test
