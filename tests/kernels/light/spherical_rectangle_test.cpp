// Solid angles of rectangles, and directions uniform over them.
#include "kernels/light/spherical_rectangle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/kernels/exact_vector.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::spherical_rectangle_test {
namespace {

constexpr double kPi = std::numbers::pi;

/// The parallelogram with these three corners, relative to the shading point, in extended precision.
struct Exact4 {
  Exact3 corner, next, previous;

  [[nodiscard]] Exact3 at(long double s, long double t) const {
    return corner + s * (next - corner) + t * (previous - corner);
  }
  [[nodiscard]] Exact3 normal() const { return normalize(cross(next - corner, previous - corner)); }
  /// Fractions of the two sides at which a direction meets the plane.
  [[nodiscard]] std::pair<long double, long double> meet(const Exact3& direction) const {
    const Exact3 a = next - corner, b = previous - corner, n = normal();
    const Exact3 p = (dot(corner, n) / dot(direction, n)) * direction - corner;
    return {dot(cross(p, b), n) / dot(cross(a, b), n), dot(cross(a, p), n) / dot(cross(a, b), n)};
  }
  [[nodiscard]] long double distance() const { return std::abs(dot(corner, normal())); }
  [[nodiscard]] long double farthest() const {
    return std::max({length(corner), length(next), length(previous), length(at(1, 1))});
  }
  /// Of the part between two fractions of each side; Van Oosterom and Strackee 1983, for two triangles.
  [[nodiscard]] long double solid_angle(long double s0 = 0, long double s1 = 1, long double t0 = 0,
                                        long double t1 = 1) const {
    const auto triangle = [](const Exact3& a, const Exact3& b, const Exact3& c) {
      const long double ra = length(a), rb = length(b), rc = length(c);
      return 2 * std::atan2(std::abs(dot(a, cross(b - a, c - a))),
                            ra * rb * rc + dot(a, b) * rc + dot(b, c) * ra + dot(c, a) * rb);
    };
    const Exact3 a = at(s0, t0), b = at(s1, t0), c = at(s1, t1), d = at(s0, t1);
    return triangle(a, b, c) + triangle(a, c, d);
  }
  /// The kernel's bound: 1e-6 of the value and what moving each corner by 2^-23 of the farthest one's
  /// distance along each axis can change.
  [[nodiscard]] long double solid_angle_error() const {
    const long double truth = solid_angle(), step = farthest() * 0x1p-23L;
    long double sum = 1e-6L * truth;
    for (Exact3 Exact4::*corner_of : {&Exact4::corner, &Exact4::next, &Exact4::previous})
      for (long double Exact3::*axis : {&Exact3::x, &Exact3::y, &Exact3::z}) {
        long double change = 0;
        for (const long double sign : {-1.0L, 1.0L}) {
          Exact4 moved = *this;
          moved.*corner_of.*axis += sign * step;
          change = std::max(change, std::abs(moved.solid_angle() - truth));
        }
        sum += change;
      }
    return sum;
  }
};

/// Corner, next, previous in single precision.
using Corners = std::array<vec3, 3>;

Exact4 exact(const Corners& c) { return {exact(c[0]), exact(c[1]), exact(c[2])}; }

SphericalRectangle spherical(const Corners& c) { return spherical_rectangle(c[0], c[1], c[2]); }

/// x and y of the corner in the rectangle's frame, its sides, its distance; in a random frame.
Corners placed(RandomNumbers& random, double x, double y, double width, double height, double distance) {
  const Exact3 n = random.direction(), ex = normalize(cross(n, random.direction())), ey = cross(n, ex);
  const auto at = [&](long double u, long double v) {
    return rounded(u * ex + v * ey + (long double)distance * n);
  };
  return {at(x, y), at(x + width, y), at(x, y + height)};
}

/// Of any shape and place, down to slivers of a thousandth and a hundred-thousandth above the plane.
Corners random_rectangle(RandomNumbers& random) {
  const double w = std::pow(10, random.between(-3, 1)), h = std::pow(10, random.between(-3, 1)),
               z = std::pow(10, random.between(-5, 1));
  if (random.below(3) == 0) return placed(random, random.between(-3, 3), random.between(-3, 3), w, h, z);
  return placed(random, random.between(-2, 1) * w, random.between(-2, 1) * h, w, h, z);
}

/// Of any shape and place and with right angles to the last digit: integer multiples of the columns of a
/// rotation matrix, the one of an integer quaternion times its norm.
Corners exact_rectangle(RandomNumbers& random) {
  for (;;) {
    const auto small = [&] { return std::int64_t(random.below(8)) - 4; };
    const std::int64_t a = small(), b = small(), c = small(), d = small(),
                       norm = a * a + b * b + c * c + d * d;
    if (norm == 0) continue;
    const std::int64_t x[] = {a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)},
                       y[] = {2 * (b * c - a * d), a * a - b * b + c * c - d * d, 2 * (c * d + a * b)},
                       z[] = {2 * (b * d + a * c), 2 * (c * d - a * b), a * a - b * b - c * c + d * d};
    const double limit = 0x1p22 / double(norm) / 3;
    const auto length = [&] { return std::int64_t(std::exp(random.between(0, std::log(limit)))); };
    const std::int64_t w = length(), h = length(), distance = random.below(2) == 0 ? length() : -length();
    const bool anywhere = random.below(3) == 0;
    const auto start = [&](std::int64_t side) {
      return std::int64_t(anywhere ? random.between(-limit, limit) : random.between(-2, 1) * double(side));
    };
    const std::int64_t u = start(w), v = start(h);
    const auto corner = [&](std::int64_t s, std::int64_t t) {
      float p[3];
      for (int i = 0; i < 3; ++i) p[i] = float(s * x[i] + t * y[i] + distance * z[i]);  // below 2^24: exact
      return make_vec3(p[0], p[1], p[2]);
    };
    return {corner(u, v), corner(u + w, v), corner(u, v + h)};
  }
}

TEST(SphericalRectangle, TheRiseKeepsItsDigits) {
  RandomNumbers random(8);
  double worst = 0;
  for (int i = 0; i < 100'000; ++i) {
    const float z = float(std::pow(10, random.between(-6, 0))), y0 = float(random.between(-1, 1)),
                height = float(std::pow(10, random.between(-4, 0))), y1 = y0 + height, c = z * z;
    const float rise = rectangle_rise(c, y0, y1, height, std::sqrt(c + y0 * y0), std::sqrt(c + y1 * y1));
    const long double lc = c, a = y0, b = (long double)y0 + height, r0 = std::sqrt(lc + a * a),
                      r1 = std::sqrt(lc + b * b);
    // By the sines of latitude, h, as differences of 1 - |h|: these stay exact where h is close to 1.
    const auto beside = [&](long double y, long double r) { return lc / (r * (r + std::abs(y))); };
    const long double difference = a >= 0   ? beside(a, r0) - beside(b, r1)
                                   : b <= 0 ? beside(b, r1) - beside(a, r0)
                                            : 2 - beside(a, r0) - beside(b, r1);
    worst = std::max(worst, std::abs(double(rise / (difference * r0 * r1) - 1)));
  }
  EXPECT_LT(worst, 10 * 0x1p-24);  // ten operations on positive numbers
}

TEST(SphericalRectangle, KnownSolidAngles) {
  // A cube's face from its centre, from either side; of a cube of another size.
  const vec3 p = make_vec3(-1, -1, 1), q = make_vec3(1, -1, 1), r = make_vec3(-1, 1, 1);
  EXPECT_NEAR(spherical_rectangle(p, q, r).solid_angle, 4 * kPi / 6, 2e-6);
  EXPECT_NEAR(spherical_rectangle(p, r, q).solid_angle, 4 * kPi / 6, 2e-6);
  EXPECT_NEAR(spherical_rectangle(negate(p), negate(q), negate(r)).solid_angle, 4 * kPi / 6, 2e-6);
  EXPECT_NEAR(spherical_rectangle(scale(p, 1e6f), scale(q, 1e6f), scale(r, 1e6f)).solid_angle, 4 * kPi / 6,
              2e-6);
  EXPECT_NEAR(spherical_rectangle(scale(p, 1e-6f), scale(q, 1e-6f), scale(r, 1e-6f)).solid_angle, 4 * kPi / 6,
              2e-6);
  // Almost the half space, a quarter of it above a corner, half of it above an edge.
  EXPECT_NEAR(spherical_rectangle(make_vec3(-1, -1, 1e-7f), make_vec3(1, -1, 1e-7f), make_vec3(-1, 1, 1e-7f))
                  .solid_angle,
              2 * kPi, 5e-6);
  EXPECT_NEAR(
      spherical_rectangle(make_vec3(0, 0, 1e-7f), make_vec3(1, 0, 1e-7f), make_vec3(0, 1, 1e-7f)).solid_angle,
      kPi / 2, 2e-6);
  EXPECT_NEAR(spherical_rectangle(make_vec3(-1, 0, 1e-7f), make_vec3(1, 0, 1e-7f), make_vec3(-1, 1, 1e-7f))
                  .solid_angle,
              kPi, 3e-6);
}

TEST(SphericalRectangle, AgreesWithExtendedPrecision) {
  RandomNumbers random(1);
  double worst = 0;
  for (int i = 0; i < 60'000; ++i) {
    const Corners corners = i % 2 == 0 ? random_rectangle(random) : exact_rectangle(random);
    const Exact4 truth = exact(corners);
    const double error = double(std::abs(spherical(corners).solid_angle - truth.solid_angle()));
    worst = std::max(worst, error / double(truth.solid_angle_error()));
  }
  EXPECT_LT(worst, 1) << "error over its bound";
}

TEST(SphericalRectangle, WellShapedOnesArePrecise) {
  // Neither slivers nor at a grazing angle: nothing magnifies the rounding of the corners, 2^-24 of 6 at most
  // at a distance of 1, which eight operations at most use.
  RandomNumbers random(2);
  double worst = 0;
  for (int i = 0; i < 60'000; ++i) {
    const double size = std::pow(10, random.between(-2, 0.5));
    const Corners corners = placed(random, random.between(-1.5, 0.5) * size, random.between(-1.5, 0.5) * size,
                                   size, size * random.between(0.5, 2), 1);
    const long double truth = exact(corners).solid_angle();
    worst = std::max(worst, std::abs(double(spherical(corners).solid_angle / truth - 1)));
  }
  EXPECT_LT(worst, 8 * 6 * 0x1p-24);
}

TEST(SphericalRectangle, DegenerateOnes) {
  const vec3 a = make_vec3(1, 0, 0), b = make_vec3(1, 2, 0), c = make_vec3(1, 0, 3), o = make_vec3(0, 0, 0);
  EXPECT_EQ(spherical_rectangle(a, a, a).solid_angle, 0);
  EXPECT_EQ(spherical_rectangle(a, b, a).solid_angle, 0);
  EXPECT_EQ(spherical_rectangle(a, a, c).solid_angle, 0);
  EXPECT_EQ(spherical_rectangle(o, o, o).solid_angle, 0);
  // In its plane: beside it nothing is seen; within it, at an edge and at a corner, anything up to the half
  // space, and a direction.
  const auto in_plane = [](float x, float y) {
    return spherical_rectangle(make_vec3(x, y, 0), make_vec3(x + 1, y, 0), make_vec3(x, y + 1, 0));
  };
  EXPECT_LT(in_plane(0.5f, 0.25f).solid_angle, 1e-6);
  EXPECT_LT(in_plane(-1.5f, -3).solid_angle, 1e-6);
  for (const auto& [x, y] :
       {std::pair(-0.5f, -0.25f), std::pair(-0.5f, 0.0f), std::pair(-1.0f, -1.0f), std::pair(0.0f, 0.0f)}) {
    const SphericalRectangle s = in_plane(x, y);
    EXPECT_GE(s.solid_angle, 0);
    EXPECT_LT(s.solid_angle, 2 * kPi + 1e-5);
    for (const float u : {0.0f, 0.3f, ONE_MINUS_EPSILON})
      for (const float v : {0.0f, 0.6f, ONE_MINUS_EPSILON})
        EXPECT_NEAR(double(length(exact(sample_spherical_rectangle(s, u, v)))), 1, 1e-6) << x << ", " << y;
  }
}

TEST(SphericalRectangle, DirectionsAreUniformOverTheSolidAngle) {
  constexpr int kSide = 12;
  RandomNumbers random(3);
  struct Case {
    const char* what;
    double x, y, width, height, distance;
  };
  const Case cases[] = {
      {"overhead", -1, -1, 2, 2, 1},
      {"aside", 1, 0.5, 2, 1, 1},
      {"large", -50, -70, 100, 120, 1},
      {"in the distance", -0.03, -0.02, 0.06, 0.05, 1},
      {"in the distance and aside", 2, 3, 0.4, 0.3, 1},
      {"close to the plane, within", -0.4, -0.7, 1, 1, 1e-3},
      {"close to the plane, beside", 0.01, -0.5, 1, 1, 1e-3},
      {"close to the plane, beside both", 0.02, 0.01, 1, 1, 1e-3},
      {"very close to the plane", -0.4, -0.7, 1, 1, 1e-5},
      {"close to an edge", -1e-3, -0.5, 1, 1, 1e-3},
      {"close to the next edge", -0.5, -1 - 1e-3, 1, 1, 1e-3},
      {"close to a corner", 1e-3, -1e-3, 1, 1, 1e-3},
      {"sliver along x", -1, 0.3, 2, 0.02, 0.5},
      {"sliver along y", 0.3, -1, 0.02, 2, 0.5},
      {"long, at its end", 0.1, -0.05, 100, 0.1, 0.3},
      {"long, at its middle", -0.05, -50, 0.1, 100, 0.3},
  };
  std::vector<double> ps;
  for (const Case& c : cases)
    for (int turn = 0; turn < 2; ++turn) {
      const Corners corners = placed(random, c.x, c.y, c.width, c.height, c.distance);
      const SphericalRectangle s = spherical(corners);
      ASSERT_GT(s.solid_angle, SMALL_RECTANGLE_SOLID_ANGLE) << c.what;
      const Exact4 truth = exact(corners);
      // Cells of about equal solid angle, or all the light would be in a few of those near the plane: bounds
      // that are uniform in the angle seen from the point above the middle of the other side.
      const auto bounds = [&](double start, double extent) {
        std::vector<long double> out;
        const double from = std::asinh(start / c.distance), to = std::asinh((start + extent) / c.distance);
        for (int i = 0; i <= kSide; ++i)
          out.push_back((c.distance * std::sinh(from + (to - from) * i / kSide) - start) / extent);
        out.front() = 0;
        out.back() = 1;
        return out;
      };
      const std::vector<long double> bs = bounds(c.x, c.width), bt = bounds(c.y, c.height);
      constexpr int kDirections = 40'000;
      std::vector<double> expected, counts(kSide * kSide);
      for (std::size_t j = 0; j < kSide; ++j)
        for (std::size_t i = 0; i < kSide; ++i)
          expected.push_back(
              double(truth.solid_angle(bs[i], bs[i + 1], bt[j], bt[j + 1]) / truth.solid_angle()) *
              kDirections);
      for (int k = 0; k < kDirections; ++k) {
        const auto [fs, ft] =
            truth.meet(exact(sample_spherical_rectangle(s, random.unit_float(), random.unit_float())));
        const auto cell = [](const std::vector<long double>& of, long double x) {
          const auto next = std::upper_bound(of.begin() + 1, of.end() - 1, x);
          return std::size_t(next - of.begin()) - 1;
        };
        ++counts[cell(bt, ft) * kSide + cell(bs, fs)];
      }
      ps.push_back(statistics::chi_square_test(counts, expected).p);
      EXPECT_GT(ps.back(), statistics::sidak_significance(0.01, 2 * std::size(cases))) << c.what;
    }
}

TEST(SphericalRectangle, EachNumberCutsOffItsShare) {
  // u of the solid angle is before the direction's line across, and v of that line's part of it, so far as
  // single precision knows direction, solid angle and the angles that u is added to.
  RandomNumbers random(4);
  double worst_u = 0, worst_v = 0;
  int count = 0;
  for (int i = 0; i < 60'000; ++i) {
    const Corners corners = exact_rectangle(random);
    const SphericalRectangle s = spherical(corners);
    if (!(s.solid_angle > SMALL_RECTANGLE_SOLID_ANGLE)) continue;
    ++count;
    const Exact4 truth = exact(corners);
    const Exact3 a = truth.next - truth.corner, b = truth.previous - truth.corner, n = truth.normal();
    const long double whole = truth.solid_angle();
    const auto shares = [&](const Exact3& d) {
      const auto [x, y] = truth.meet(d);
      const long double fs = std::clamp(x, 0.0L, 1.0L), ft = std::clamp(y, 0.0L, 1.0L);
      const auto sine = [&](long double t) {
        const Exact3 p = truth.at(fs, t);
        return dot(p, b) / (length(p) * length(b));
      };
      return std::pair(truth.solid_angle(0, fs) / whole, (sine(ft) - sine(0)) / (sine(1) - sine(0)));
    };
    const float u = random.unit_float(), v = random.unit_float();
    const Exact3 d = exact(sample_spherical_rectangle(s, u, v));
    const auto [du, dv] = shares(d);
    long double tolerance_u =
        0x1p-22L * (2 * (long double)kPi) / whole + 4 * truth.solid_angle_error() / whole;
    long double tolerance_v = tolerance_u;
    for (const Exact3& e : {normalize(a), normalize(b), n})
      for (const long double sign : {-1.0L, 1.0L}) {
        const auto [mu, mv] = shares(d + (sign * 0x1p-22L) * e);
        tolerance_u += std::abs(mu - du);
        tolerance_v += std::abs(mv - dv);
      }
    worst_u = std::max(worst_u, double(std::abs(du - (long double)u) / tolerance_u));
    worst_v = std::max(worst_v, double(std::abs(dv - (long double)v) / tolerance_v));
  }
  EXPECT_GT(count, 20'000);
  EXPECT_LT(worst_u, 1) << "of " << count;
  EXPECT_LT(worst_v, 1);
}

TEST(SphericalRectangle, PointsStayInTheRectangle) {
  // But for rounding: three operations for each unit vector of the frame, two for their sum and three for its
  // length put the direction off by up to 8 x 2^-24. The plane's own distance is off by as much of the
  // farthest corner's. Either moves the point where they meet by that times r / distance.
  RandomNumbers random(5);
  int count = 0;
  for (int i = 0; i < 200'000; ++i) {
    const Corners corners = exact_rectangle(random);
    const SphericalRectangle s = spherical(corners);
    if (!(s.solid_angle > SMALL_RECTANGLE_SOLID_ANGLE)) continue;
    ++count;
    const float ends[] = {0.0f, ONE_MINUS_EPSILON, random.unit_float(), random.unit_float()};
    const Exact3 d = exact(sample_spherical_rectangle(s, ends[random.below(4)], ends[random.below(4)]));
    const Exact4 truth = exact(corners);
    const auto [fs, ft] = truth.meet(d);
    const Exact3 hit = truth.at(fs, ft);
    const long double beyond = std::max(length(truth.next - truth.corner) * std::max(-fs, fs - 1),
                                        length(truth.previous - truth.corner) * std::max(-ft, ft - 1));
    const long double tolerance =
        0x1p-21L * (truth.farthest() + length(hit)) * length(hit) / truth.distance();
    ASSERT_LT(beyond, tolerance) << i;
  }
  EXPECT_GT(count, 70'000);
}

TEST(SphericalRectangle, ExtremeNumbersGiveItsCorners) {
  RandomNumbers random(6);
  for (const double distance : {10.0, 1.0, 0.01}) {
    const Corners corners = placed(random, -0.3, 0.2, 1, 2, distance);
    const SphericalRectangle s = spherical(corners);
    const auto near = [&](float u, float v, const Exact3& corner) {
      EXPECT_LT(double(length(exact(sample_spherical_rectangle(s, u, v)) - normalize(corner))), 1e-4)
          << u << ", " << v << " at " << distance;
    };
    const Exact4 truth = exact(corners);
    near(0, 0, truth.at(0, 0));
    near(ONE_MINUS_EPSILON, 0, truth.at(1, 0));
    near(0, ONE_MINUS_EPSILON, truth.at(0, 1));
    near(ONE_MINUS_EPSILON, ONE_MINUS_EPSILON, truth.at(1, 1));
  }
}

TEST(SphericalRectangle, DirectionsAreUnitVectorsWhateverTheRectangle) {
  RandomNumbers random(7);
  for (int i = 0; i < 200'000; ++i) {
    const float size = float(std::pow(10.0, random.between(-6, 6)));
    Corners corners = random_rectangle(random);
    for (vec3& c : corners) c = scale(c, size);
    if (i % 100 == 0) corners[1] = corners[0];
    if (i % 100 == 1) corners[2] = corners[0] = make_vec3(0, 0, 0);
    const SphericalRectangle s = spherical(corners);
    const float numbers[] = {0.0f, ONE_MINUS_EPSILON, random.unit_float()};
    const vec3 d = sample_spherical_rectangle(s, numbers[i % 3], numbers[i / 3 % 3]);
    ASSERT_GE(s.solid_angle, 0);
    ASSERT_LT(s.solid_angle, 2 * kPi + 1e-5);
    if (s.solid_angle <= SMALL_RECTANGLE_SOLID_ANGLE) continue;
    ASSERT_NEAR(double(length(exact(d))), 1, 1e-6) << "size " << size << ", solid angle " << s.solid_angle;
  }
}

}  // namespace
}  // namespace penumbra::spherical_rectangle_test
