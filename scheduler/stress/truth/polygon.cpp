#include "scheduler/stress/truth/polygon.h"

#include <utility>

namespace penumbra::stress {
namespace {

/// The double-axis moment: the integral of (w.u)^e (n.u) over a convex loop inside both hemispheres; positive
/// if the loop is counter-clockwise seen along its directions.
Quad double_axis_moment(const Loop& loop, const Quad3& n, const Quad3& w, int exponent) {
  Quad axial = 0, boundary = 0;
  if (exponent % 2 == 1) {
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) axial += solid_angle(loop[0], loop[i], loop[i + 1]);
  }
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Quad3 a = normalize(loop[i]), b = normalize(loop[(i + 1) % loop.size()]);
    const Quad3 outward = cross(b, a);
    const Quad sine = length(outward);
    if (sine < Quad(1e-30)) continue;
    const Quad3 g = (1 / sine) * outward, across = normalize(b - dot(a, b) * a);
    const Quad wa = dot(w, a), wt = dot(w, across);
    const Quad c = sqrt_q(wa * wa + wt * wt), phi = atan2_q(wt, wa);
    const Quad low = -phi, high = atan2_q(sine, dot(a, b)) - phi;
    // The recurrence for F_k = integral of cos^k over [low, high], from k = e mod 2 up. It keeps c^k and the
    // powers of the ends' cosines.
    const bool odd = exponent % 2 == 1;
    const Quad cl = cos_q(low), sl = sin_q(low), ch = cos_q(high), sh = sin_q(high);
    Quad f = odd ? sh - sl : high - low, power = odd ? c : Quad(1);
    Quad pl = odd ? cl * cl : cl, ph = odd ? ch * ch : ch, sum = 0;
    for (int k = odd ? 1 : 0; k < exponent; k += 2) {
      sum += power * f;
      f = (ph * sh - pl * sl + (k + 1) * f) / (k + 2);
      power *= c * c;
      pl *= cl * cl;
      ph *= ch * ch;
    }
    axial -= dot(w, g) * sum;
    boundary -= dot(n, g) * power * f;
  }
  return (dot(w, n) * axial + boundary) / (exponent + 2);
}

/// Calls visit(triangle, sign) for the triangles of a fan of each loop, as seen from x. The triangles are
/// oriented to have positive volume, which is counter-clockwise along their directions; sign is that of the
/// loop's front.
template <typename Visit>
void for_fan(const std::vector<Loop>& loops, const Quad3& x, const Visit& visit) {
  for (const Loop& loop : loops) {
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
      Loop t{loop[0] - x, loop[i] - x, loop[i + 1] - x};
      const Quad volume = dot(t[0], cross(t[1] - t[0], t[2] - t[0]));
      if (volume == 0) continue;
      if (volume < 0) std::swap(t[1], t[2]);
      visit(t, volume < 0 ? Quad(1) : Quad(-1));
    }
  }
}

}  // namespace

Loop clip(const Loop& loop, const Quad3& n) {
  Loop kept;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Quad3 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    const Quad za = dot(n, a), zb = dot(n, b);
    if (za >= 0) kept.push_back(a);
    if ((za >= 0) != (zb >= 0)) kept.push_back(a + (za / (za - zb)) * (b - a));
  }
  return kept;
}

Quad solid_angle(const Quad3& a, const Quad3& b, const Quad3& c) {
  const Quad3 u = normalize(a), v = normalize(b), w = normalize(c);
  return 2 * atan2_q(abs_q(dot(u, cross(v - u, w - u))), 1 + dot(u, v) + dot(v, w) + dot(w, u));
}

Quad projected_solid_angle(const Loop& convex, const Quad3& n) {
  const Loop loop = clip(convex, n);
  Quad twice = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Quad3 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    const Quad3 g = cross(a, b);
    const Quad sine = length(g);
    if (sine > 0) twice += angle_between(a, b) * dot(n, g) / sine;
  }
  return twice / 2;
}

Quad irradiance(const std::vector<Loop>& loops, const Quad3& x, const Quad3& n) {
  Quad total = 0;
  for_fan(loops, x, [&](const Loop& t, Quad sign) { total += sign * projected_solid_angle(t, n); });
  return total;
}

Quad lobe(const std::vector<Loop>& loops, const Quad3& x, const Quad3& n, const Quad3& w, int exponent) {
  Quad total = 0;
  for_fan(loops, x, [&](const Loop& t, Quad sign) {
    const Loop loop = clip(clip(t, n), w);
    if (loop.size() >= 3) total += sign * double_axis_moment(loop, n, w, exponent);
  });
  return (exponent + 2) / (2 * kQuadPi) * total;
}

}  // namespace penumbra::stress
