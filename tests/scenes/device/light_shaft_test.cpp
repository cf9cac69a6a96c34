// Shafts to flat lights against straight ways through them, one by one.
#include "scenes/device/light_shaft.h"

#include <gtest/gtest.h>

#include <glm/glm.hpp>
#include <optional>
#include <random>

namespace penumbra {
namespace {

using glm::dvec3;

constexpr double kSlack = 1e-9;  ///< of ends and obstacles of size 1

class LightShaftTest : public testing::Test {
 protected:
  double number() { return std::uniform_real_distribution(-1.0, 1.0)(random_); }
  dvec3 point() { return {number(), number(), number()}; }

  /// A convex polygon about the place.
  ShaftEnd polygon(const dvec3& middle, double size, int points) {
    const dvec3 n = glm::normalize(point()), x = glm::normalize(glm::cross(n, point())), y = glm::cross(n, x);
    std::vector<dvec3> corners;
    for (int k = 0; k < points; ++k) corners.push_back(middle + size * (number() * x + number() * y));
    return hull_in_plane(corners, {n, -glm::dot(n, middle)});
  }
  ShaftPlane plane_of(const dvec3& a, const dvec3& b, const dvec3& c) {
    const dvec3 n = glm::normalize(glm::cross(b - a, c - a));
    return {n, -glm::dot(n, a)};
  }
  Obstacle triangle(const dvec3& a, const dvec3& b, const dvec3& c) {
    return {{a, b, c}, 3, plane_of(a, b, c)};
  }

  dvec3 within(const ShaftEnd& end) {
    dvec3 sum(0);
    double weights = 0;
    for (const dvec3& corner : end.corners) {
      const double weight = -std::log(0.5 * (1 + number()) + 1e-300);
      sum += weight * corner;
      weights += weight;
    }
    return sum / weights;
  }

  /// A straight way from the one to the other, where each is above the other; nothing if none was found.
  std::optional<std::pair<dvec3, dvec3>> way(const ShaftEnd& surface, const ShaftEnd& light) {
    for (int k = 0; k < 64; ++k) {
      const dvec3 a = within(surface), b = within(light);
      if (light.plane.height(a) > 1e-3 && surface.plane.height(b) > 1e-3) return std::pair(a, b);
    }
    return {};
  }

  std::mt19937 random_{7};
};

TEST_F(LightShaftTest, HullsHoldTheirPointsAndAreConvex) {
  for (int round = 0; round < 300; ++round) {
    const ShaftEnd end = polygon(point(), 1, 3 + round % 12);
    ASSERT_GE(end.corners.size(), 3u);
    for (std::size_t i = 0; i < end.corners.size(); ++i) {
      const dvec3 &a = end.corners[i], &b = end.corners[(i + 1) % end.corners.size()];
      for (const dvec3& p : end.corners)
        EXPECT_GE(glm::dot(glm::cross(end.plane.n, b - a), p - a), -1e-12) << round;
    }
  }
}

TEST_F(LightShaftTest, WhatIsInAWayIsMet) {
  int met = 0, cut = 0;
  for (int round = 0; round < 4000; ++round) {
    const ShaftEnd surface = polygon(dvec3(0), 1, 5);
    const ShaftEnd light = polygon(3.0 * point(), 1, 7);
    const LightShaft shaft(surface, light, kSlack);
    const auto between = way(surface, light);
    if (!between) continue;
    ASSERT_FALSE(shaft.is_empty()) << round;
    cut += shaft.light_is_cut() || shaft.surface_is_cut() ? 1 : 0;
    // A triangle about a point of the way, however small.
    const double share = 0.5 + 0.49 * number(), size = std::exp2(-16 * (1 + number()) / 2);
    const dvec3 at = between->first + share * (between->second - between->first);
    const dvec3 u = size * point(), v = size * point();
    EXPECT_TRUE(shaft.may_meet(triangle(at + u, at + v, at - u - v))) << round;
    Obstacle box{{}, 8, {}};
    for (int k = 0; k < 8; ++k)
      box.points[std::size_t(k)] = at + size * dvec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    EXPECT_TRUE(shaft.may_meet(box)) << round;
    ++met;
  }
  EXPECT_GT(met, 1000);
  EXPECT_GT(cut, 300);
}

TEST_F(LightShaftTest, LittleElseIsMet) {
  // Of triangles that none of many ways meets, those that are met all the same are near edges of the hull.
  int missed = 0, met = 0;
  for (int round = 0; round < 200; ++round) {
    const ShaftEnd surface = polygon(dvec3(0), 1, 5), light = polygon(3.0 * point(), 1, 7);
    const LightShaft shaft(surface, light, kSlack);
    if (!way(surface, light)) continue;
    for (int k = 0; k < 20; ++k) {
      const dvec3 a = 2.0 * point(), b = a + 0.3 * point(), c = a + 0.3 * point();
      bool blocks = false;
      const ShaftPlane plane = plane_of(a, b, c);
      for (int w = 0; w < 3000 && !blocks; ++w) {
        const dvec3 p = within(surface), q = within(light);
        if (light.plane.height(p) < 0 || surface.plane.height(q) < 0) continue;
        const double hp = plane.height(p), hq = plane.height(q);
        if (hp * hq > 0) continue;
        const dvec3 at = p + hp / (hp - hq) * (q - p);
        blocks = glm::dot(glm::cross(b - a, at - a), plane.n) > 0 &&
                 glm::dot(glm::cross(c - b, at - b), plane.n) > 0 &&
                 glm::dot(glm::cross(a - c, at - c), plane.n) > 0;
      }
      if (blocks) continue;
      ++missed;
      met += shaft.may_meet(triangle(a, b, c)) ? 1 : 0;
    }
  }
  EXPECT_GT(missed, 1000);
  EXPECT_LT(met, missed / 10);
}

TEST_F(LightShaftTest, WhatIsInTheEndsOwnPlanesIsNotInTheWay) {
  // A floor and a light above it; the rest of the floor, of the ceiling, and a wall along the floor's edge.
  const std::vector<dvec3> floor{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<dvec3> area_light{{0.2, 0.2, 2}, {0.2, 0.8, 2}, {0.8, 0.8, 2}, {0.8, 0.2, 2}};
  const LightShaft shaft(ShaftEnd{floor, {{0, 0, 1}, 0}}, ShaftEnd{area_light, {{0, 0, -1}, 2}}, kSlack);
  EXPECT_FALSE(shaft.light_is_cut() || shaft.surface_is_cut());
  EXPECT_FALSE(shaft.may_meet(triangle({-1, -1, 0}, {3, 0, 0}, {0, 3, 0})));
  EXPECT_FALSE(shaft.may_meet(triangle({-1, -1, 2}, {3, 0, 2}, {0, 3, 2})));
  EXPECT_FALSE(shaft.may_meet(triangle({0, 0, 0}, {0, 1, 0}, {0, 0.5, 3})));
  EXPECT_TRUE(shaft.may_meet(triangle({0.1, 0, 0}, {0.1, 1, 0}, {0.1, 0.5, 3})));
}

TEST_F(LightShaftTest, OfAnEndBehindTheOtherIsEmpty) {
  const std::vector<dvec3> floor{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  const std::vector<dvec3> above{{0, 0, 1}, {0, 1, 1}, {1, 1, 1}}, below{{0, 0, -1}, {0, 1, -1}, {1, 1, -1}};
  const ShaftPlane up{{0, 0, 1}, 0};
  EXPECT_FALSE(LightShaft({floor, up}, {above, {{0, 0, -1}, 1}}, kSlack).is_empty());
  EXPECT_TRUE(LightShaft({floor, up}, {above, {{0, 0, 1}, -1}}, kSlack).is_empty());
  const LightShaft beneath({floor, up}, {below, {{0, 0, 1}, 1}}, kSlack);
  EXPECT_TRUE(beneath.is_empty());
  EXPECT_TRUE(beneath.light_is_cut());
  EXPECT_FALSE(beneath.may_meet(triangle({0, 0, 0.5}, {1, 0, 0.5}, {0, 1, 0.5})));
}

TEST_F(LightShaftTest, HidingIsForEveryPoint) {
  int hidden = 0, open = 0;
  for (int round = 0; round < 20000; ++round) {
    const ShaftEnd surface = polygon(dvec3(0), 0.2, 4), light = polygon(2.0 * point(), 1, 6);
    const auto between = way(surface, light);
    if (!between) continue;
    const dvec3 p = between->first + 0.5 * (1 + number()) * (between->second - between->first);
    const bool hides = hides_some({{p}, 1, {}}, surface, light);
    hidden += hides ? 1 : 0;
    open += hides ? 0 : 1;
    for (int k = 0; hides && k < 32; ++k) {
      const dvec3 from = within(surface);
      const double start = light.plane.height(from), height = light.plane.height(p);
      ASSERT_TRUE(start > height && height > 0) << round;
      const dvec3 at = from + start / (start - height) * (p - from);
      for (std::size_t i = 0; i < light.corners.size(); ++i) {
        const dvec3 &a = light.corners[i], &b = light.corners[(i + 1) % light.corners.size()];
        ASSERT_GE(glm::dot(glm::cross(light.plane.n, b - a), at - a), -1e-12) << round;
      }
    }
  }
  EXPECT_GT(hidden, 100);
  EXPECT_GT(open, 1000);
}

}  // namespace
}  // namespace penumbra
