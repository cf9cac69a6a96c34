// Frames, and directions sampled in them.
#include "kernels/math/frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::frame_test {
namespace {

constexpr double kSignificance = 0.01;

void expect_orthonormal(const vec3& n) {
  // Each component is a few rounded sums of products of components up to 1; 1 / (1 + n.z) is well conditioned
  // on the hemisphere that the sign of n.z picks.
  constexpr double kTolerance = 8 * 0x1p-24;
  const Exact3 s = exact(from_frame(n, 1, 0, 0)), t = exact(from_frame(n, 0, 1, 0)),
               u = exact(from_frame(n, 0, 0, 1));
  EXPECT_NEAR(double(dot(s, s)), 1, kTolerance);
  EXPECT_NEAR(double(dot(t, t)), 1, kTolerance);
  EXPECT_NEAR(double(dot(s, t)), 0, kTolerance);
  EXPECT_NEAR(double(dot(s, u)), 0, kTolerance);
  EXPECT_NEAR(double(dot(t, u)), 0, kTolerance);
  EXPECT_EQ(u.x, n.x);
  EXPECT_EQ(u.y, n.y);
  EXPECT_EQ(u.z, n.z);
  EXPECT_NEAR(double(dot(cross(s, t), u)), 1, kTolerance) << "right-handed";
}

TEST(Frame, IsOrthonormalAboutAnyNormal) {
  RandomNumbers random(1);
  for (int i = 0; i < 50'000 && !testing::Test::HasFailure(); ++i)
    expect_orthonormal(rounded(random.direction()));
}

TEST(Frame, TangentAxisFollowsAVectorPerpendicularlyToTheNormal) {
  RandomNumbers random(5);
  for (int i = 0; i < 50'000; ++i) {
    const Exact3 n = random.direction();
    const double tilt = std::pow(10, random.between(-3, 0));  // from n
    const Exact3 v =
        (long double)std::pow(10, random.between(-20, 20)) * (n + (long double)tilt * random.direction());
    const vec3 unit = rounded(n), along = rounded(v);
    const Exact3 part = exact(along) - dot(exact(along), n) * n;
    if (length(part) < 1e-3L * length(exact(along))) continue;  // either will do
    const Exact3 s = exact(tangent_axis(unit, along));
    ASSERT_NEAR(double(dot(s, s)), 1, 8 * 0x1p-24);
    ASSERT_NEAR(double(dot(s, exact(unit))), 0, 8 * 0x1p-24);
    ASSERT_LE(length(s - normalize(part)), 16 * 0x1p-24L * length(exact(along)) / length(part));
  }
}

TEST(Frame, TangentAxisIsTheFramesFirstWhereThereIsNone) {
  RandomNumbers random(6);
  for (int i = 0; i < 1000; ++i) {
    const vec3 n = rounded(random.direction()), first = from_frame(n, 1, 0, 0);
    for (const vec3& v : {make_vec3(0, 0, 0), n, scale(n, -1e20f)}) {
      const vec3 s = tangent_axis(n, v);
      ASSERT_TRUE(s.x == first.x && s.y == first.y && s.z == first.z);
    }
  }
}

TEST(Frame, IsOrthonormalTowardsThePoles) {
  RandomNumbers random(2);
  for (double tilt = 1; tilt > 1e-20; tilt *= 0.3)
    for (double pole : {1.0, -1.0})
      for (int i = 0; i < 20; ++i) {
        const Exact3 d = random.direction();
        expect_orthonormal(rounded(normalize({tilt * d.x, tilt * d.y, pole})));
      }
}

TEST(Frame, IsOrthonormalOnTheEquatorAndTheAxes) {
  RandomNumbers random(3);
  for (float z : {0.0f, -0.0f, 1e-30f, -1e-30f})
    for (int i = 0; i < 100; ++i) {
      const double phi = random.between(0, 2 * std::numbers::pi);
      expect_orthonormal(make_vec3(float(std::cos(phi)), float(std::sin(phi)), z));
    }
  for (float sign : {1.0f, -1.0f}) {
    expect_orthonormal(make_vec3(sign, 0, 0));
    expect_orthonormal(make_vec3(0, sign, 0));
    expect_orthonormal(make_vec3(0, 0, sign));
  }
}

/// Counts directions on a grid whose cells are equally probable, by two coordinates in [0, 1).
class Cells {
 public:
  void add(double a, double b) {
    const auto cell = [](double x) { return std::size_t(std::min(std::max(x, 0.0) * kSide, kSide - 1.0)); };
    ++counts_[cell(a) * kSide + cell(b)];
  }
  [[nodiscard]] double p() const {
    double total = 0;
    for (double c : counts_) total += c;
    return statistics::chi_square_test(counts_,
                                       std::vector<double>(counts_.size(), total / double(counts_.size())))
        .p;
  }

 private:
  static constexpr int kSide = 20;
  std::vector<double> counts_ = std::vector<double>(kSide * kSide);
};

double turns(const Exact3& d) {
  const double t = double(std::atan2(d.y, d.x)) / (2 * std::numbers::pi);
  return t < 0 ? t + 1 : t;
}

TEST(DirectionSampling, DensitiesAreTheStatedOnes) {
  const vec3 up = make_vec3(0, 0, 1);
  RandomNumbers random(4);
  Cells cosine, uniform, sphere;
  for (int i = 0; i < 400'000; ++i) {
    const float u = random.unit_float(), v = random.unit_float();
    const Exact3 c = exact(sample_cosine_hemisphere(up, u, v));
    cosine.add(double(c.z * c.z), turns(c));  // P(cos < z) = z^2
    const Exact3 h = exact(sample_uniform_hemisphere(up, u, v));
    uniform.add(double(h.z), turns(h));
    const Exact3 s = exact(sample_uniform_sphere(u, v));
    sphere.add(double((1 + s.z) / 2), turns(s));
  }
  const double limit = statistics::sidak_significance(kSignificance, 3);
  EXPECT_GT(cosine.p(), limit);
  EXPECT_GT(uniform.p(), limit);
  EXPECT_GT(sphere.p(), limit);
}

TEST(DirectionSampling, TurnsWithTheNormal) {
  RandomNumbers random(5);
  for (int k = 0; k < 20; ++k) {
    const vec3 n = rounded(random.direction());
    Exact3 cosine_mean, uniform_mean;
    constexpr int kCount = 20'000;
    for (int i = 0; i < kCount; ++i) {
      const float u = random.unit_float(), v = random.unit_float();
      cosine_mean = cosine_mean + exact(sample_cosine_hemisphere(n, u, v));
      uniform_mean = uniform_mean + exact(sample_uniform_hemisphere(n, u, v));
    }
    // The mean directions are 2/3 n and 1/2 n; a component's standard deviation is at most 0.6, so 5 sigma.
    const double tolerance = 5 * 0.6 / std::sqrt(double(kCount));
    const Exact3 by_cosine = (1.0L / kCount) * cosine_mean - (2.0L / 3) * exact(n);
    const Exact3 by_area = (1.0L / kCount) * uniform_mean - 0.5L * exact(n);
    EXPECT_LT(double(length(by_cosine)), std::sqrt(3.0) * tolerance);
    EXPECT_LT(double(length(by_area)), std::sqrt(3.0) * tolerance);
  }
}

TEST(DirectionSampling, ExtremeNumbersGiveUnitVectorsAboveTheHorizon) {
  RandomNumbers random(6);
  for (float u : {0.0f, 0x1p-24f, 0.5f, ONE_MINUS_EPSILON})
    for (float v : {0.0f, 0x1p-24f, 0.25f, 0.5f, 0.75f, ONE_MINUS_EPSILON})
      for (int i = 0; i < 50; ++i) {
        const vec3 n = rounded(random.direction());
        for (const vec3& d : {sample_cosine_hemisphere(n, u, v), sample_uniform_hemisphere(n, u, v)}) {
          EXPECT_NEAR(double(length(exact(d))), 1, 8 * 0x1p-24);
          EXPECT_GT(double(dot(exact(d), exact(n))), -4 * 0x1p-24);
        }
        EXPECT_NEAR(double(length(exact(sample_uniform_sphere(u, v)))), 1, 8 * 0x1p-24);
      }
}

}  // namespace
}  // namespace penumbra::frame_test
