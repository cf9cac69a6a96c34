// A polygon light and a surface point that it illuminates.
#pragma once

#include "scheduler/stress/cases/inputs.h"
#include "scheduler/stress/quantity_list.h"
#include "scheduler/stress/truth/polygon.h"

namespace penumbra::stress {

/// Corners are floats; position and directions are doubles.
struct PolygonSetting {
  std::vector<Points> loops;  ///< outer loops are counter-clockwise seen from the front
  Point x{0, 0, 0}, n{0, 0, 1}, w{0, 0, 1};
  double exponent = -1;  ///< negative: no lobe
  bool two_sided = false;
};

inline std::vector<Loop> quad_loops(const PolygonSetting& s) {
  std::vector<Loop> loops;
  for (const Points& points : s.loops) {
    loops.emplace_back();
    for (const Point& p : points) loops.back().push_back(quad(rounded(p)));
  }
  return loops;
}

/// Irradiance or lobe. All lanes get the same inputs, so their differences are added to the error.
inline KernelMeasurement measurement(const PolygonSetting& s, bool of_lobe) {
  KernelMeasurement m;
  m.quantity = QUANTITY_POLYGON;
  for (const Point& p : {s.x, s.n, s.w}) m.inputs.insert(m.inputs.end(), {p.x, p.y, p.z});
  m.inputs.insert(m.inputs.end(), {s.exponent, s.two_sided ? 1.0 : 0.0, 0.0});
  for (const Points& points : s.loops) {
    for (std::size_t i = 0; i <= points.size(); ++i) {
      const Point p = rounded(points[i % points.size()]);
      m.inputs.insert(m.inputs.end(), {p.x, p.y, p.z, i == 0 ? 1.0 : 0.0});
    }
  }
  m.inputs[11] = double(m.inputs.size() - 12) / 4;
  m.value = [of_lobe](const Numbers& out) { return Numbers{out[of_lobe ? 1 : 0] + out[2]}; };
  return m;
}

}  // namespace penumbra::stress
