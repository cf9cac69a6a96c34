#include "scheduler/stress/truth/spherical.h"

#include "scheduler/stress/truth/polygon.h"

namespace penumbra::stress {
namespace {

/// Finds where the increasing function f on [0, 1] reaches `target`.
template <typename F>
Quad bisect(const F& f, Quad target) {
  Quad low = 0, high = 1;
  for (int i = 0; i < 115; ++i) {
    const Quad middle = (low + high) / 2;
    (f(middle) < target ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// The point on the arc from unit vector a to unit vector b, at `angle` from a.
Quad3 along_arc(const Quad3& a, const Quad3& b, Quad angle) {
  const Quad3 across = normalize(b - dot(a, b) * a);
  return cos_q(angle) * a + sin_q(angle) * across;
}

}  // namespace

Quad3 sample_triangle(const Quad3& a, const Quad3& b, const Quad3& c, Quad u, Quad v) {
  const Quad3 p = normalize(a), q = normalize(b), r = normalize(c);
  const Quad side = angle_between(p, r), whole = solid_angle(p, q, r);
  const auto end_at = [&](Quad t) { return along_arc(p, r, t * side); };
  const Quad t = u <= 0   ? Quad(0)
                 : u >= 1 ? Quad(1)
                          : bisect([&](Quad s) { return solid_angle(p, q, end_at(s)); }, u * whole);
  const Quad3 end = end_at(t);
  // 1 - cos is uniform along the arc.
  const Quad angle = 2 * asin_q(min_q(sqrt_q(max_q(v, 0)) * sin_q(angle_between(q, end) / 2), 1));
  return along_arc(q, end, angle);
}

Quad rectangle_solid_angle(const Quad3& corner, const Quad3& next, const Quad3& previous) {
  const Quad3 opposite = next + previous - corner;
  return solid_angle(corner, next, opposite) + solid_angle(corner, opposite, previous);
}

Quad3 sample_rectangle(const Quad3& corner, const Quad3& next, const Quad3& previous, Quad u, Quad v) {
  const Quad3 along = next - corner, up = previous - corner, axis = normalize(up);
  const Quad whole = rectangle_solid_angle(corner, next, previous);
  const Quad s =
      u <= 0   ? Quad(0)
      : u >= 1 ? Quad(1)
               : bisect([&](Quad t) { return rectangle_solid_angle(corner, corner + t * along, previous); },
                        u * whole);
  const auto at = [&](Quad t) { return normalize(corner + s * along + t * up); };
  const auto latitude = [&](Quad t) { return dot(at(t), axis); };
  const Quad low = latitude(0), high = latitude(1);
  return at(v <= 0 ? Quad(0) : v >= 1 ? Quad(1) : bisect(latitude, low + v * (high - low)));
}

}  // namespace penumbra::stress
