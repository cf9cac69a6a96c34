// Solid angles of triangles, and directions uniform over them.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/kernels/light_scenes.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::spherical_triangle_test {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(SphericalTriangle, KnownSolidAngles) {
  const vec3 x = make_vec3(1, 0, 0), y = make_vec3(0, 1, 0), z = make_vec3(0, 0, 1);
  EXPECT_NEAR(spherical_triangle(x, y, z).solid_angle, kPi / 2, 1e-6);  // an octant
  EXPECT_NEAR(spherical_triangle(scale(x, 1e-3f), scale(y, 10), scale(z, 1e4f)).solid_angle, kPi / 2, 1e-6);
  EXPECT_NEAR(spherical_triangle(x, z, y).solid_angle, kPi / 2, 1e-6);  // either orientation
  // The horizon all around from just below the plane of a large triangle.
  const vec3 a = make_vec3(1e6f, 0, 1), b = make_vec3(-1e6f, 2e6f, 1), c = make_vec3(-1e6f, -2e6f, 1);
  EXPECT_NEAR(spherical_triangle(a, b, c).solid_angle, 2 * kPi, 1e-5);
  // A regular tetrahedron's face from its centre.
  EXPECT_NEAR(spherical_triangle(make_vec3(1, 1, 1), make_vec3(1, -1, -1), make_vec3(-1, 1, -1)).solid_angle,
              kPi, 1e-6);
}

TEST(SphericalTriangle, AgreesWithExtendedPrecision) {
  RandomNumbers random(1);
  double worst = 0;
  for (int i = 0; i < 200'000; ++i) {
    const double size = std::pow(10.0, random.between(-3, 1));
    const Exact3 at = random.direction();
    const vec3 a = rounded(at + random.point(size)), b = rounded(at + random.point(size)),
               c = rounded(at + random.point(size));
    const double truth = exact_solid_angle(exact(a), exact(b), exact(c));
    const double got = spherical_triangle(a, b, c).solid_angle;
    // Each unit vertex is off by up to 2^-23, which moves an edge sideways: the area by as much times the
    // edge's length, and more where its ends are nearly antipodal and hardly say where it runs.
    const Exact3 u = normalize(exact(a)), v = normalize(exact(b)), w = normalize(exact(c));
    long double perimeter = 0;
    for (const Exact3& edge : {v - u, w - v, u - w})
      perimeter += length(edge) / std::sqrt(1 - std::min(1 - 1e-12L, dot(edge, edge) / 4));
    const double tolerance = 4 * 0x1p-23 * double(perimeter) + 4e-7 * truth;
    worst = std::max(worst, std::abs(got - truth) / tolerance);
  }
  EXPECT_LT(worst, 1) << "error over its bound";
}

TEST(SphericalTriangle, DegenerateOnesSubtendNothing) {
  const vec3 a = make_vec3(1, 0, 0), b = make_vec3(0, 1, 0);
  EXPECT_EQ(spherical_triangle(a, a, a).solid_angle, 0);
  EXPECT_EQ(spherical_triangle(a, b, a).solid_angle, 0);
  EXPECT_LT(spherical_triangle(a, b, make_vec3(1, 1, 0)).solid_angle, 1e-6);
  EXPECT_EQ(spherical_triangle(make_vec3(0, 0, 0), a, b).solid_angle, 0);  // seen from its vertex
}

/// Splits the triangle into 4^kLevels flat parts; the part of a direction, and each part's share of the solid
/// angle.
class Parts {
 public:
  Parts(const Exact3& a, const Exact3& b, const Exact3& c) : a_(a), b_(b), c_(c) {
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; i + j < kSide; ++j)
        for (int half = 0; half < (i + j < kSide - 1 ? 2 : 1); ++half) {
          const double shift = half != 0 ? 1 : 0;
          const Exact3 corner = at(i + shift, j + shift);
          share_.push_back(exact_solid_angle(corner, half != 0 ? at(i, j + 1) : at(i + 1, j),
                                             half != 0 ? at(i + 1, j) : at(i, j + 1)));
        }
    counts_.resize(share_.size());
  }
  /// False for a direction outside, by more than rounding.
  bool add(const Exact3& d) {
    const long double wa = dot(d, cross(b_, c_)), wb = dot(d, cross(c_, a_)), wc = dot(d, cross(a_, b_)),
                      sum = wa + wb + wc;
    const double u = double(wb / sum), v = double(wc / sum), w = double(wa / sum);
    if (std::min({u, v, w}) < -1e-4) return false;
    const double x = std::clamp(u, 0.0, 1 - 1e-9) * kSide, y = std::clamp(v, 0.0, 1 - 1e-9) * kSide;
    int i = std::min(int(x), kSide - 1), j = std::min(int(y), kSide - 1 - i);
    const bool second = (x - i) + (y - j) > 1 && i + j < kSide - 1;
    int index = second ? 1 : 0;
    for (int k = 0; k < i; ++k) index += 2 * (kSide - k) - 1;
    index += 2 * j;
    ++counts_[std::size_t(index)];
    return true;
  }
  [[nodiscard]] double p() const {
    double total = 0, whole = 0;
    for (double c : counts_) total += c;
    for (double s : share_) whole += s;
    std::vector<double> expected;
    for (double s : share_) expected.push_back(s / whole * total);
    return statistics::chi_square_test(counts_, expected).p;
  }

 private:
  static constexpr int kSide = 12;
  [[nodiscard]] Exact3 at(double i, double j) const {
    return a_ + (long double)(i / kSide) * (b_ - a_) + (long double)(j / kSide) * (c_ - a_);
  }
  Exact3 a_, b_, c_;
  std::vector<double> share_, counts_;
};

TEST(SphericalTriangle, DirectionsAreUniformOverTheSolidAngle) {
  RandomNumbers random(2);
  std::vector<double> ps;
  for (double size : {0.03, 0.3, 1.0, 5.0, 100.0})
    for (int k = 0; k < 4; ++k) {
      const Exact3 at = random.direction();
      const vec3 a = rounded(at + random.point(size)), b = rounded(at + random.point(size)),
                 c = rounded(at + random.point(size));
      const SphericalTriangle t = spherical_triangle(a, b, c);
      if (!(t.solid_angle > SMALL_SOLID_ANGLE)) continue;
      Parts parts(exact(a), exact(b), exact(c));
      int outside = 0;
      for (int i = 0; i < 60'000; ++i) {
        const vec3 d = sample_spherical_triangle(t, random.unit_float(), random.unit_float());
        outside += parts.add(exact(d)) ? 0 : 1;
      }
      EXPECT_EQ(outside, 0) << "of size " << size;
      ps.push_back(parts.p());
    }
  ASSERT_GT(ps.size(), 15u);
  for (double p : ps) EXPECT_GT(p, statistics::sidak_significance(0.01, ps.size()));
}

TEST(SphericalTriangle, ExtremeNumbersGiveItsCorners) {
  const vec3 a = make_vec3(1, 0.1f, 0), b = make_vec3(0.2f, 1, 0.1f), c = make_vec3(0, 0.3f, 1);
  const SphericalTriangle t = spherical_triangle(a, b, c);
  const auto near = [&](float u, float v, const vec3& corner) {
    EXPECT_LT(double(length(exact(sample_spherical_triangle(t, u, v)) - normalize(exact(corner)))), 1e-3)
        << u << ", " << v;
  };
  near(0, ONE_MINUS_EPSILON, a);
  near(0, 0, b);
  near(ONE_MINUS_EPSILON, 0, b);
  near(ONE_MINUS_EPSILON, ONE_MINUS_EPSILON, c);
}

TEST(SphericalTriangle, DirectionsAreUnitVectorsWhateverTheTriangle) {
  RandomNumbers random(3);
  for (int i = 0; i < 200'000; ++i) {
    const double size = std::pow(10.0, random.between(-6, 6));
    const Exact3 at = random.direction();
    const vec3 a = rounded(at + random.point(size)), b = rounded(at + random.point(size)),
               c = rounded(at + random.point(size));
    const SphericalTriangle t = spherical_triangle(a, b, i % 100 == 0 ? negate(a) : i % 100 == 1 ? a : c);
    const float numbers[] = {0.0f, ONE_MINUS_EPSILON, random.unit_float()};
    const vec3 d = sample_spherical_triangle(t, numbers[i % 3], numbers[i / 3 % 3]);
    if (t.solid_angle <= SMALL_SOLID_ANGLE) continue;
    ASSERT_NEAR(double(length(exact(d))), 1, 1e-6) << "size " << size << ", solid angle " << t.solid_angle;
  }
}

}  // namespace
}  // namespace penumbra::spherical_triangle_test
