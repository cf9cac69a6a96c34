// The closed form of polygon lights: irradiance.
#include "scheduler/stress/cases/cases.h"
#include "scheduler/stress/cases/polygon_setting.h"
#include "scheduler/stress/truth/polygon.h"

namespace penumbra::stress {
namespace polygon_cases {
namespace {

// The documented bounds of polygon_terms: absolute; of a light of small angular size, relative times it.
constexpr double kBound = 1.4e-14, kSmallBound = 3e-15;
const std::string kWhy = "documented bound of polygon_terms: roundings of some dozen angles in double";

struct Entry {
  const char *name, *stiff;
  PolygonSetting setting;
};

/// A wall at x = 1 that faces the origin, between two heights.
Points wall(double low, double high) { return {{1, 1, low}, {1, -1, low}, {1, -1, high}, {1, 1, high}}; }
Points star() {
  Points points;
  for (int i = 0; i < 10; ++i) {
    const double angle = -2 * 3.14159265358979 * i / 10, radius = i % 2 == 0 ? 1 : .4;
    points.push_back({radius * std::cos(angle), radius * std::sin(angle), .5});
  }
  return points;
}
Points scaled(const Points& points, double scale, const Point& offset = {}) {
  Points result;
  for (const Point& p : points)
    result.push_back({p.x * scale + offset.x, p.y * scale + offset.y, p.z * scale + offset.z});
  return result;
}
Points reversed(const Points& points) { return {points.rbegin(), points.rend()}; }
Points triangle(const Point& a, const Point& b, const Point& c) { return {a, b, c}; }

const Point kTilted = unit(.3, -.2, 1);

const std::vector<Entry>& entries() {
  static const std::vector<Entry> list = {
      {"overhead", "nothing: a square as large as its distance", {{square(1, 1)}}},
      {"behind", "the back of a one-sided light: exactly dark", {{reversed(square(1, 1))}}},
      {"star-with-hole", "a concave outline with a hole", {{star(), square(.2, .5)}}},
      {"horizon-crossed", "half of the light is below the horizon", {{wall(-1, 1)}}},
      {"horizon-crossed-tilted", "the horizon cuts two edges at odd places", {{wall(-.3, .7)}, {}, kTilted}},
      {"horizon-edge-on-it", "an edge in the horizon", {{wall(0, 1)}}},
      {"horizon-edge-1e-30-below", "an edge a smallest distance below the horizon", {{wall(-1e-30, 1)}}},
      {"horizon-edge-1e-7-above", "an edge just above the horizon", {{wall(1e-7, 1)}}},
      {"horizon-sliver", "only 1e-6 of the light's height is above the horizon", {{wall(-1, 1e-6)}}},
      {"horizon-vertex-on-it",
       "a vertex in the horizon",
       {{triangle({1, .5, 0}, {1, -.7, -.6}, {1, -.2, .8})}}},
      {"below-horizon", "all of the light is below the horizon: exactly dark", {{wall(-2, -1e-6)}}},
      {"plane-outside",
       "a point of the light's plane, beside it",
       {{square(1, 0)}, {3, 0, 0}, unit(-1, 0, 1)}},
      {"plane-1e-12-outside",
       "1e-12 below the light's plane, beside it",
       {{square(1, 0)}, {3, 0, -1e-12}, unit(-1, 0, 1)}},
      {"inside-1e-12", "1e-12 below the middle of the light", {{square(1, 0)}, {.3, .2, -1e-12}}},
      {"edge-1e-9", "1e-9 below an edge of the light", {{square(1, 0)}, {1, .2, -1e-9}}},
      {"edge-1e-9-beside", "1e-9 below and beside an edge", {{square(1, 0)}, {1 + 1e-9, .2, -1e-9}}},
      {"vertex-1e-9", "1e-9 below a vertex of the light", {{square(1, 0)}, {1, 1, -1e-9}, kTilted}},
      {"antipodal-2e-7",
       "an edge whose ends are 2e-7 short of opposite directions",
       {{triangle({-1, 0, 1e-7}, {0, 5, 3}, {1, 0, 1e-7})}}},
      {"antipodal-1e-12",
       "1e-12 from the middle of an edge",
       {{triangle({-1, 0, 0}, {0, 1, 1}, {1, 0, 0})}, {0, 1e-12, 0}, unit(0, 0, 1)}},
      {"huge-1e6", "all of the sky but 1e-6 of it", {{square(1e6, 1)}}},
      {"sliver-1e7",
       "a triangle 1e7 times as long as wide",
       {{triangle({0, 0, 1}, {.5, 1e-7, 1}, {1, 0, 1})}}},
      {"collinear", "a triangle without area", {{triangle({0, 0, 1}, {.25, .5, 1}, {.5, 1, 1})}}},
      {"duplicate-vertices",
       "every vertex twice",
       {{{{-1, -1, 1}, {-1, -1, 1}, {-1, 1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, -1, 1}, {1, -1, 1}}}}},
      {"normal-down",
       "a normal at the pole of the frame's construction",
       {{reversed(square(1, -1))}, {}, {0, 0, -1}}},
      {"normal-almost-down",
       "a normal 1e-9 from the pole of the frame's construction",
       {{reversed(wall(-1, 1))}, {2, 0, 0}, unit(1e-9, 1e-9, -1)}},
      {"scale-1e-4", "a scene of 1e-4 units", {{scaled(star(), 1e-4)}}},
      {"scale-1e5", "a scene of 1e5 units", {{scaled(star(), 1e5)}}},
      {"scale-1e-15", "a scene of 1e-15 units", {{scaled(star(), 1e-15)}}},
      {"shift-1e3",
       "a scene shifted by 1e3",
       {{scaled(square(1, 1), 1, {1e3, 2e3, -1e3})}, {1e3, 2e3, -1e3}}},
      {"shift-1e7",
       "a scene shifted by 1e7",
       {{scaled(square(1, 1), 1, {1e7, -1e7, 1e7})}, {1e7, -1e7, 1e7}}},
  };
  return list;
}

/// Lights of small angular size.
constexpr struct {
  const char *name, *stiff;
  double size;
} kSmall[] = {{"small-1e-3", "a light of 1e-6 steradians", 1e-3},
              {"small-1e-6", "a light of 1e-12 steradians", 1e-6},
              {"small-1e-9", "a light of 1e-18 steradians", 1e-9}};

void add(std::vector<Case>& cases, const Entry& e, Allowed allowed) {
  const PolygonSetting s = e.setting;
  cases.push_back({std::string("polygon/") + e.name,
                   e.stiff,
                   "irradiance per radiance",
                   measurement(s, false),
                   {[s] {
                      const Quad signed_value = irradiance(quad_loops(s), quad(s.x), quad(s.n));
                      return Quads{s.two_sided ? abs_q(signed_value) : max_q(signed_value, 0)};
                    },
                    "Lambert's sum over clipped triangles in 113 bits"},
                   std::move(allowed)});
}

/// On an outline the limit depends on the direction that the point is approached from.
void add_undefined(std::vector<Case>& cases, const char* name, const char* stiff, const PolygonSetting& s) {
  cases.push_back({name, stiff, "irradiance per radiance", measurement(s, false),
                   known(kQuadPi / 2, "the middle of the range: the limit depends on the way"),
                   absolute(1.5707963267948966, "any number from 0 to pi")});
}

}  // namespace

void add(std::vector<Case>& cases) {
  for (const Entry& e : entries()) add(cases, e, absolute(kBound, kWhy));
  // From below the whole hemisphere is lit, from above nothing; tilted by t, shares of (1 +- cos t) / 2.
  for (const auto& [name, n] :
       {std::pair("inside-exact", Point{0, 0, 1}), std::pair("inside-exact-tilted", kTilted)}) {
    KernelMeasurement m = measurement({{square(1, 0)}, {.3, .2, 0}, n, {}, -1, true}, false);
    m.value = [z = n.z](const Numbers& out) {
      const double below = 3.14159265358979324 / 2 * (1 + z), above = 3.14159265358979324 / 2 * (1 - z);
      return Numbers{std::min(std::abs(out[0] - below), std::abs(out[0] - above))};
    };
    cases.push_back({std::string("polygon/") + name, "a point of the light",
                     "distance from the limit from either side", m, known(0, "closed form"),
                     absolute(kBound, kWhy)});
  }
  add_undefined(cases, "polygon/edge-exact", "a point of an edge of the light", {{square(1, 0)}, {1, .2, 0}});
  add_undefined(cases, "polygon/vertex-exact", "a vertex of the light", {{square(1, 0)}, {1, 1, 0}, kTilted});
  add_undefined(cases, "polygon/antipodal-exact", "an edge with opposite directions as ends",
                {{triangle({-1, 0, 0}, {0, 1, 1}, {1, 0, 0})}});
  for (const auto& e : kSmall) {
    // Floats keep 1e-9 about 0 only.
    const double x = e.size < 1e-7 ? 0 : .4, y = .75 * x;
    add(cases, {e.name, e.stiff, {{triangle({x, y, 1}, {x, y + e.size, 1}, {x + e.size, y, 1})}}},
        relative(kSmallBound / e.size, "documented bound of polygon_terms: 3e-15 / angular size"));
  }
}

}  // namespace polygon_cases

void add_polygon_cases(std::vector<Case>& cases) { polygon_cases::add(cases); }

}  // namespace penumbra::stress
