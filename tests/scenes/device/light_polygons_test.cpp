// The builder's tables of polygons for emitting meshes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "tests/scenes/device/light_builder_pieces.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;
using enum EmitterSampling;

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
  EXPECT_EQ(builder.features(), std::uint64_t(FEATURE_POLYGONS | FEATURE_PROJECTED | FEATURE_SOLID_ANGLE));
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

}  // namespace
}  // namespace penumbra
