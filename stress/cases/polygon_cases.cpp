// The closed forms of polygon lights: irradiance and Phong lobe.
#include <cmath>
#include <numbers>

#include "stress/cases/cases.h"
#include "stress/quantity_list.h"
#include "stress/truth/polygon.h"

namespace penumbra::stress {
namespace {

struct Point {
  double x, y, z;
};
using Points = std::vector<Point>;

/// A polygon light and what looks at it. Corners are floats; position and directions doubles.
struct Setting {
  std::vector<Points> loops;  ///< outer ones counter-clockwise seen from the front
  Point x{0, 0, 0}, n{0, 0, 1}, w{0, 0, 1};
  double exponent = -1;  ///< none
  bool two_sided = false;
};

double rounded(double v) { return double(float(v)); }
Quad3 quad(const Point& p) { return {p.x, p.y, p.z}; }
Point unit(double x, double y, double z) {
  const double length = std::sqrt(x * x + y * y + z * z);
  return {x / length, y / length, z / length};
}

std::vector<Loop> quad_loops(const Setting& s) {
  std::vector<Loop> loops;
  for (const Points& points : s.loops) {
    loops.emplace_back();
    for (const Point& p : points) loops.back().push_back({rounded(p.x), rounded(p.y), rounded(p.z)});
  }
  return loops;
}

KernelMeasurement measurement(const Setting& s, bool of_lobe) {
  KernelMeasurement m;
  m.quantity = QUANTITY_POLYGON;
  for (const Point& p : {s.x, s.n, s.w}) m.inputs.insert(m.inputs.end(), {p.x, p.y, p.z});
  m.inputs.insert(m.inputs.end(), {s.exponent, s.two_sided ? 1.0 : 0.0, 0.0});
  for (const Points& points : s.loops) {
    for (std::size_t i = 0; i <= points.size(); ++i) {
      const Point& p = points[i % points.size()];
      m.inputs.insert(m.inputs.end(), {rounded(p.x), rounded(p.y), rounded(p.z), i == 0 ? 1.0 : 0.0});
    }
  }
  m.inputs[11] = double(m.inputs.size() - 12) / 4;
  // Lanes with the same question must have the same answer.
  m.value = [of_lobe](const Numbers& out) { return Numbers{out[of_lobe ? 1 : 0] + out[2]}; };
  return m;
}

/// The quad (-1, -1) to (1, 1) at height z, times a size, facing down, seen from the origin.
Points square(double size, double z, double x = 0, double y = 0) {
  return {{x - size, y - size, z}, {x - size, y + size, z}, {x + size, y + size, z}, {x + size, y - size, z}};
}

}  // namespace

void add_polygon_cases(std::vector<Case>& cases) {
  cases.push_back({"polygon/overhead",
                   "nothing: a square as large as its distance",
                   "irradiance per radiance",
                   measurement({{square(1, 1)}}, false),
                   {[] {
                      return Quads{irradiance(quad_loops({{square(1, 1)}}), {0, 0, 0}, {0, 0, 1})};
                    },
                    "Lambert's sum in 113 bits"},
                   absolute(1.4e-14, "documented bound of polygon_terms")});
}

}  // namespace penumbra::stress
