#include "tests/kernels/polygon/polygon_oracle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

namespace penumbra {

namespace {

/// Calls visit(triangle, sign) for triangles whose sum is the polygon, a fan for each loop. They have
/// vertices relative to the receiver and positive determinants; the sign is positive where the receiver sees
/// the front of a part that is there, or the back of one that a hole takes away.
void for_fan(const QuadLoops& loops, const Quad3& x,
             const std::function<void(const QuadLoop&, Quad)>& visit) {
  for (const QuadLoop& loop : loops) {
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
      QuadLoop triangle{loop[0] - x, loop[i] - x, loop[i + 1] - x};
      const Quad volume = dot(triangle[0], cross(triangle[1] - triangle[0], triangle[2] - triangle[0]));
      if (volume == 0) continue;
      // Counter-clockwise from the front gives a negative volume for a point in front.
      if (volume < 0) std::swap(triangle[1], triangle[2]);
      visit(triangle, volume < 0 ? 1 : -1);
    }
  }
}

/// Of a convex polygon of unit vectors with positive determinants (Van Oosterom and Strackee 1983).
Quad solid_angle(const QuadLoop& p) {
  Quad sum = 0;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const Quad3 &a = p[0], &b = p[i], &c = p[i + 1];
    sum += 2 * atan2_q(dot(a, cross(b, c)), 1 + dot(a, b) + dot(b, c) + dot(c, a));
  }
  return sum;
}

/// Integral of (w.u)^e (n.u) over a polygon of unit vectors inside both hemispheres.
Quad double_axis_moment(const QuadLoop& p, const Quad3& n, const Quad3& w, int exponent) {
  // Arvo's axial moment of order e - 1, times e, and the boundary term of order e.
  Quad axial = exponent % 2 == 1 ? solid_angle(p) : Quad(0), boundary = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Quad3 a = p[i], b = p[(i + 1) % p.size()], g = cross(b, a);
    const Quad sine = length(g);
    if (sine < Quad(1e-30)) continue;
    const Quad3 outward = (1 / sine) * g, t = normalize(b - dot(a, b) * a);
    const Quad angle = angle_between(a, b), wa = dot(w, a), wt = dot(w, t);
    const Quad c = sqrt_q(wa * wa + wt * wt), phi = atan2_q(wt, wa);
    const Quad x = -phi, y = angle - phi;
    const Quad cx = cos_q(x), sx = sin_q(x), cy = cos_q(y), sy = sin_q(y);
    // F of order k, c^k and the powers of the cosines of order k + 1.
    int k = exponent % 2;
    Quad f = k == 0 ? y - x : sy - sx, power = k == 0 ? Quad(1) : c, px = k == 0 ? cx : cx * cx,
         py = k == 0 ? cy : cy * cy, sum = 0;
    for (; k < exponent; k += 2) {
      sum += power * f;
      f = (py * sy - px * sx + (k + 1) * f) / (k + 2);
      power *= c * c;
      px *= cx * cx;
      py *= cy * cy;
    }
    axial -= dot(w, outward) * sum;
    boundary -= dot(n, outward) * power * f;
  }
  return (dot(w, n) * axial + boundary) / (exponent + 2);
}

struct Point {
  double x, y, z;
};
Point point(const Quad3& a) { return {double(a.x), double(a.y), double(a.z)}; }
Point combine(double s, const Point& a, double t, const Point& b) {
  return {s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z};
}
double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// Gauss-Legendre nodes of [0, 1] and weights.
constexpr int kNodes = 10;
std::array<std::array<double, 2>, kNodes> gauss_rule() {
  std::array<std::array<double, 2>, kNodes> rule{};
  for (int i = 0; i < kNodes; ++i) {
    double x = std::cos(std::numbers::pi * (i + .75) / (kNodes + .5)), slope = 1;
    for (int step = 0; step < 20; ++step) {
      double p = 1, before = 0;
      for (int j = 0; j < kNodes; ++j) {
        const double next = ((2 * j + 1) * x * p - j * before) / (j + 1);
        before = p;
        p = next;
      }
      slope = kNodes * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    rule[std::size_t(i)] = {(1 + x) / 2, 1 / ((1 - x * x) * slope * slope)};
  }
  return rule;
}

using Integrand = std::function<double(const Point&)>;

/// Over the parameters of a triangle, whose area is 1/2 there.
double gauss_triangle(const Integrand& f, const Point& a, const Point& b, const Point& c) {
  static const auto rule = gauss_rule();
  double sum = 0;
  for (const auto& [s, ws] : rule) {
    for (const auto& [t, wt] : rule) {
      const Point edge = combine(1 - t, b, t, c);
      sum += ws * wt * s * f(combine(1 - s, a, s, edge));
    }
  }
  return sum;
}

double adaptive_triangle(const Integrand& f, const Point& a, const Point& b, const Point& c, double whole,
                         double tolerance, int depth) {
  const Point ab = combine(.5, a, .5, b), bc = combine(.5, b, .5, c), ca = combine(.5, c, .5, a);
  const Point parts[4][3] = {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}};
  double values[4], sum = 0;
  for (int i = 0; i < 4; ++i) {
    values[i] = gauss_triangle(f, parts[i][0], parts[i][1], parts[i][2]) / 4;
    sum += values[i];
  }
  if (depth == 0 || std::abs(sum - whole) < tolerance) return sum;
  sum = 0;
  for (int i = 0; i < 4; ++i)
    sum +=
        adaptive_triangle(f, parts[i][0], parts[i][1], parts[i][2], 4 * values[i], tolerance, depth - 1) / 4;
  return sum;
}

}  // namespace

QuadLoops quad(const std::vector<std::vector<vec3>>& loops) {
  QuadLoops result;
  for (const std::vector<vec3>& loop : loops) {
    result.emplace_back();
    for (const vec3& corner : loop) result.back().push_back(quad(corner));
  }
  return result;
}

QuadLoop clip(const QuadLoop& loop, const Quad3& n) {
  QuadLoop kept;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Quad3 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    const Quad za = dot(n, a), zb = dot(n, b);
    if (za >= 0) kept.push_back(a);
    if ((za >= 0) != (zb >= 0)) kept.push_back(a + (za / (za - zb)) * (b - a));
  }
  return kept;
}

Quad oracle_irradiance(const QuadLoops& loops, const QuadReceiver& receiver) {
  Quad total = 0;
  for_fan(loops, receiver.x, [&](const QuadLoop& triangle, Quad sign) {
    const QuadLoop p = clip(triangle, receiver.n);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Quad3 g = cross(p[i], p[(i + 1) % p.size()]);
      const Quad sine = length(g);
      if (sine > 0)
        total += sign / 2 * angle_between(p[i], p[(i + 1) % p.size()]) * dot(receiver.n, g) / sine;
    }
  });
  return total;
}

Quad oracle_lobe(const QuadLoops& loops, const QuadReceiver& receiver, int exponent) {
  Quad total = 0;
  for_fan(loops, receiver.x, [&](const QuadLoop& triangle, Quad sign) {
    QuadLoop p = clip(clip(triangle, receiver.n), receiver.w);
    if (p.size() < 3) return;
    for (Quad3& v : p) v = normalize(v);
    total += sign * double_axis_moment(p, receiver.n, receiver.w, exponent);
  });
  return (exponent + 2) / (2 * kQuadPi) * total;
}

double quadrature(const QuadLoops& loops, const QuadReceiver& receiver,
                  const std::function<double(double x, double y, double z)>& f, double tolerance) {
  const Point n = point(receiver.n);
  double total = 0;
  for_fan(loops, receiver.x, [&](const QuadLoop& triangle, Quad sign) {
    const QuadLoop p = clip(triangle, receiver.n);
    for (std::size_t i = 1; i + 1 < p.size(); ++i) {
      // d sigma = det / |p|^3 times the area in the triangle's parameters.
      const double determinant = double(dot(p[0], cross(p[i] - p[0], p[i + 1] - p[0])));
      const Integrand over_area = [&](const Point& q) {
        const double r2 = dot(q, q), r = std::sqrt(r2);
        return f(q.x / r, q.y / r, q.z / r) * std::max(dot(n, q) / r, 0.0) * determinant / (r2 * r);
      };
      const Point a = point(p[0]), b = point(p[i]), c = point(p[i + 1]);
      total += double(sign) *
               adaptive_triangle(over_area, a, b, c, gauss_triangle(over_area, a, b, c), tolerance, 14);
    }
  });
  return total;
}

double quadrature_lobe(const QuadLoops& loops, const QuadReceiver& receiver, double exponent,
                       double tolerance) {
  const Point n = point(receiver.n), w = point(receiver.w);
  double total = 0;
  for_fan(loops, receiver.x, [&](const QuadLoop& triangle, Quad sign) {
    const QuadLoop p = clip(clip(triangle, receiver.n), receiver.w);
    for (std::size_t i = 1; i + 1 < p.size(); ++i) {
      // d sigma = det / |p|^3 times the area in the triangle's parameters.
      const double determinant = double(dot(p[0], cross(p[i] - p[0], p[i + 1] - p[0])));
      const Integrand f = [&](const Point& q) {
        const double r2 = dot(q, q), r = std::sqrt(r2);
        const double wu = std::max(dot(w, q) / r, 0.0), nu = std::max(dot(n, q) / r, 0.0);
        return std::pow(wu, exponent) * nu * determinant / (r2 * r);
      };
      const Point a = point(p[0]), b = point(p[i]), c = point(p[i + 1]);
      const double scale = (exponent + 2) / (2 * std::numbers::pi);
      total += double(sign) * scale *
               adaptive_triangle(f, a, b, c, gauss_triangle(f, a, b, c), tolerance / scale, 12);
    }
  });
  return total;
}

}  // namespace penumbra
