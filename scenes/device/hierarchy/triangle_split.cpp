#include "scenes/device/hierarchy/triangle_split.h"

namespace penumbra {
namespace {

// Relative margin of several rounding errors for the intersection of an edge with the plane.
constexpr double kMargin = 3e-7;

void clip(Box& box, const Box& by) {
  for (int k = 0; k < 3; ++k) {
    box.low[k] = std::max(box.low[k], by.low[k]);
    box.high[k] = std::min(box.high[k], by.high[k]);
  }
}

}  // namespace

std::pair<Box, Box> split_bounds(const Triangle& triangle, const Box& bounds, int axis, float position) {
  const vec3 corners[3] = {triangle.p0, triangle.p1, triangle.p2};
  Box below, above;
  for (int i = 0; i < 3; ++i) {
    const vec3 &from = corners[i], &to = corners[(i + 1) % 3];
    const double a[3] = {from.x, from.y, from.z}, b[3] = {to.x, to.y, to.z};
    if (a[axis] <= position) below.include(from);
    if (a[axis] >= position) above.include(from);
    if (!(std::min(a[axis], b[axis]) < position && position < std::max(a[axis], b[axis]))) continue;
    const double s = (position - a[axis]) / (b[axis] - a[axis]);
    for (int k = 0; k < 3; ++k) {
      const double at = a[k] + s * (b[k] - a[k]);
      const double margin = kMargin * std::max(std::abs(a[k]), std::abs(b[k]));
      const float low = float(at - margin), high = float(at + margin);
      below.low[k] = std::min(below.low[k], low);
      above.low[k] = std::min(above.low[k], low);
      below.high[k] = std::max(below.high[k], high);
      above.high[k] = std::max(above.high[k], high);
    }
  }
  clip(below, bounds);
  clip(above, bounds);
  return {below, above};
}

}  // namespace penumbra
