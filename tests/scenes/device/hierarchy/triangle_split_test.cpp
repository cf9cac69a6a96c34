// Bounding boxes of parts of a triangle.
#include "scenes/device/hierarchy/triangle_split.h"

#include <gtest/gtest.h>

#include <random>

namespace penumbra {
namespace {

bool holds(const Box& box, const double (&p)[3]) {
  for (int k = 0; k < 3; ++k)
    if (!(p[k] >= box.low[k] && p[k] <= box.high[k])) return false;
  return true;
}

bool is_inside(const Box& box, const Box& outer) {
  for (int k = 0; k < 3; ++k)
    if (box.low[k] < outer.low[k] || box.high[k] > outer.high[k]) return false;
  return true;
}

class RandomSplits : public testing::TestWithParam<float> {
 protected:
  vec3 random_point() {
    std::uniform_real_distribution<float> about(-1, 1);
    return make_vec3(GetParam() + about(random_), GetParam() + about(random_), about(random_));
  }
  std::mt19937 random_{7};
};

// Triangles of size 1 about points up to 1e4 away; parts of parts, as the builder makes them.
INSTANTIATE_TEST_SUITE_P(Offsets, RandomSplits, testing::Values(0.0f, 1.0f, 100.0f, 1e4f));

TEST_P(RandomSplits, EveryPointIsInThePartOfItsSide) {
  std::uniform_real_distribution<double> unit(0, 1);
  int cuts = 0;
  for (int i = 0; i < 200; ++i) {
    Triangle t{};
    t.p0 = random_point();
    t.p1 = random_point();
    t.p2 = random_point();
    if (i % 4 == 0) t.p1.x = t.p0.x;  // an edge in a plane that cuts
    Box bounds = bounds_of(t);
    for (int depth = 0; depth < 4; ++depth) {
      const int axis = (i + depth) % 3;
      const float position =
          i % 4 == 0 && depth == 0 && axis == 0
              ? t.p0.x
              : float(bounds.low[axis] + unit(random_) * (bounds.high[axis] - bounds.low[axis]));
      const auto [below, above] = split_bounds(t, bounds, axis, position);
      EXPECT_TRUE(is_inside(below, bounds));
      EXPECT_TRUE(is_inside(above, bounds));
      for (int n = 0; n < 100; ++n) {
        double u = unit(random_), v = unit(random_);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        if (n % 5 == 0) v = 0;  // on an edge
        const auto mix = [&](float a, float b, float c) {
          return a + u * (double(b) - a) + v * (double(c) - a);
        };
        const double p[3] = {mix(t.p0.x, t.p1.x, t.p2.x), mix(t.p0.y, t.p1.y, t.p2.y),
                             mix(t.p0.z, t.p1.z, t.p2.z)};
        if (!holds(bounds, p)) continue;
        ++cuts;
        EXPECT_TRUE(holds(p[axis] <= position ? below : above, p)) << i << ", " << depth;
      }
      bounds = depth % 2 == 0 ? below : above;
      if (!(bounds.low[axis] <= bounds.high[axis])) break;
    }
  }
  EXPECT_GT(cuts, 20000);
}

TEST(TriangleSplit, CutsAway) {
  Triangle t{};
  t.p0 = make_vec3(0, 0, 0);
  t.p1 = make_vec3(4, 0, 0);
  t.p2 = make_vec3(0, 4, 0);
  const auto [below, above] = split_bounds(t, bounds_of(t), 0, 3.0f);
  // x + y <= 4: above x = 3 no y over 1, within the stated margin of the edge's ends.
  EXPECT_NEAR(above.high[1], 1, 4 * 3e-7 + 1e-7);
  EXPECT_EQ(above.high[0], 4);
  EXPECT_EQ(below.high[1], 4);
  EXPECT_NEAR(below.high[0], 3, 4 * 3e-7 + 2e-7);
}

}  // namespace
}  // namespace penumbra
