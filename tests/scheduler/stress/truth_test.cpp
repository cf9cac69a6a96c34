// Compares the true values of `penumbra stress` with values from independent sources.
#include <gtest/gtest.h>

#include "scheduler/stress/truth/mixtures.h"
#include "scheduler/stress/truth/polygon.h"
#include "scheduler/stress/truth/quadrature.h"
#include "scheduler/stress/truth/sensitivity.h"
#include "scheduler/stress/truth/spherical.h"

namespace penumbra::stress {
namespace {

// 113 bits are 34 digits; sums and cancellation cost a few.
constexpr double kExact = 1e-30;
// Quadrature ends where its weights vanish.
constexpr double kQuadrature = 1e-25;

double error(Quad got, Quad expected) { return double(abs_q(got - expected)); }

std::vector<Loop> square(Quad half, Quad height) {
  return {{{-half, -half, height}, {-half, half, height}, {half, half, height}, {half, -half, height}}};
}
const Quad3 kUp{0, 0, 1};

TEST(Irradiance, OfARectangleIsTheFormFactorOfTextbooks) {
  // A differential element below the corner of an a x b rectangle at distance 1, both parallel (e.g. Howell,
  // A Catalog of Radiation Heat Transfer Configuration Factors, B-3); four of them make the square.
  for (const double half : {1e-3, .5, 1., 30.}) {
    const Quad a = half, root = sqrt_q(1 + a * a);
    const Quad corner = (a / root * atan2_q(a, root)) / kQuadPi;
    EXPECT_LT(error(irradiance(square(a, 1), {}, kUp), 4 * kQuadPi * corner), kExact) << half;
  }
}

TEST(Irradiance, SideSeenAndHorizon) {
  EXPECT_LT(error(irradiance(square(1, -1), {}, {0, 0, -1}), -irradiance(square(1, 1), {}, kUp)), kExact)
      << "the back is negative";
  EXPECT_EQ(double(irradiance(square(1, -1), {}, kUp)), 0) << "all of it is below the horizon";
  // An infinite wall: half of the hemisphere.
  const Quad far = 1e12;
  const std::vector<Loop> wall{{{1, far, -far}, {1, -far, -far}, {1, -far, far}, {1, far, far}}};
  EXPECT_LT(error(irradiance(wall, {}, kUp), kQuadPi / 2), 1e-11);
}

TEST(Lobe, KnownMoments) {
  // Of exponent 0 the lobe is Lambert's.
  EXPECT_LT(error(lobe(square(1, 1), {}, kUp, kUp, 0), irradiance(square(1, 1), {}, kUp) / kQuadPi), kExact);
  // Of the whole sky and along the normal it is 1.
  for (const int exponent : {0, 1, 2, 7, 100, 10001})
    EXPECT_LT(error(lobe(square(1e12, 1), {}, kUp, kUp, exponent), 1), 1e-11) << exponent;
}

TEST(Lobe, AgreesWithQuadrature) {
  const Quad3 w = normalize({.3, -.2, 1});
  for (const int exponent : {1, 2, 7, 50}) {
    const auto row = [&](Quad y) {
      return tanh_sinh(
          [&](Quad x) {
            const Quad3 p{x, y, 1};
            const Quad r = length(p);
            return exp_q(exponent * log_q(dot(w, p) / r)) / (r * r * r * r);
          },
          -1, 1);
    };
    const Quad expected = (exponent + 2) / (2 * kQuadPi) * tanh_sinh(row, -1, 1);
    EXPECT_LT(error(lobe(square(1, 1), {}, kUp, w, exponent), expected), kQuadrature) << exponent;
  }
}

TEST(SolidAngle, KnownOnes) {
  EXPECT_LT(error(solid_angle({1, 0, 0}, {0, 2, 0}, {0, 0, 3}), kQuadPi / 2), kExact);
  // A rectangle of half sides a, b at distance d: 4 asin(a b / sqrt((a^2 + d^2) (b^2 + d^2))).
  const Quad a = 1.5, b = .25, d = .5;
  const Quad expected = 4 * asin_q(a * b / sqrt_q((a * a + d * d) * (b * b + d * d)));
  EXPECT_LT(error(rectangle_solid_angle({-a, -b, d}, {a, -b, d}, {-a, b, d}), expected), kExact);
}

TEST(Samples, OfAnOctantBySymmetry) {
  const Quad3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const Quad3 halved = sample_triangle(x, y, z, .5, 1);
  EXPECT_LT(double(length(halved - normalize({1, 0, 1}))), kExact);
  const Quad3 inside = sample_triangle(x, y, z, .5, .25);  // 1 - cos is uniform: cos = 3/4
  EXPECT_LT(double(length(inside - normalize({sqrt_q(Quad(7) / 32), Quad(3) / 4, sqrt_q(Quad(7) / 32)}))),
            kExact);
  EXPECT_LT(double(length(sample_triangle(x, y, z, 0, 1) - x)), kExact);
  EXPECT_LT(double(length(sample_triangle(x, y, z, 1, 1) - z)), kExact);
  EXPECT_LT(double(length(sample_triangle(x, y, z, .3, 0) - y)), kExact);
}

TEST(Samples, OfARectangle) {
  const Quad3 corner{-2, -1, 1}, next{2, -1, 1}, previous{-2, 1, 1};
  EXPECT_LT(double(length(sample_rectangle(corner, next, previous, .5, .5) - kUp)), kExact);
  EXPECT_LT(double(length(sample_rectangle(corner, next, previous, 0, 0) - normalize(corner))), kExact);
  EXPECT_LT(double(length(sample_rectangle(corner, next, previous, 1, 0) - normalize(next))), kExact);
  // The part left of x = 1 is two of four quarters by symmetry and a rectangle of its own.
  const Quad part =
      rectangle_solid_angle(corner, {1, -1, 1}, previous) / rectangle_solid_angle(corner, next, previous);
  const Quad3 at = sample_rectangle(corner, next, previous, part, 0);
  EXPECT_LT(double(length(at - normalize({1, -1, 1}))), kExact);
}

TEST(Quadrature, KnownIntegrals) {
  EXPECT_LT(error(tanh_sinh([](Quad x) { return sqrt_q(x); }, 0, 1), Quad(2) / 3), kQuadrature);
  EXPECT_LT(error(tanh_sinh([](Quad x) { return log_q(x); }, 0, 1), -1), kQuadrature);
  EXPECT_LT(error(tanh_sinh([](Quad x) { return exp_q(x); }, -1, 3), exp_q(3) - exp_q(-1)), kQuadrature);
  EXPECT_LT(error(tanh_sinh([](Quad x) { return abs_q(x); }, {2, 0, -1}), Quad(5) / 2), kQuadrature);
}

TEST(Phong, KnownValues) {
  const Quad3 n{0, 0, 2}, wo{1, 0, 1}, mirror{-3, 0, 3};
  const PhongValue peak = phong(.5, .25, 100, n, wo, mirror);
  const Quad cosine = 1 / sqrt_q(2);
  EXPECT_LT(error(peak.f_cos, (Quad(.5) / kQuadPi + Quad(.25) * 102 / (2 * kQuadPi)) * cosine), 1e-29);
  EXPECT_LT(error(peak.pdf, (2 * cosine / kQuadPi + 101 / (2 * kQuadPi)) / 3), 1e-29);
  EXPECT_EQ(double(phong(.5, .25, 100, n, wo, {1, 0, -1}).f_cos), 0);
}

TEST(Phong, Albedos) {
  for (const double exponent : {0., 1., 33.5, 1e3, 1e5}) {
    EXPECT_LT(error(phong_albedo(exponent, 0), 1), 1e-20) << exponent;
    EXPECT_LT(error(phong_albedo(exponent, kQuadPi / 2), phong_albedo_at_horizon(exponent)), 1e-20)
        << exponent;
  }
  EXPECT_LT(error(phong_albedo_at_horizon(0), Quad(1) / 2), kExact);  // half of a cosine lobe
  EXPECT_LT(error(phong_albedo_at_horizon(1), 1 / kQuadPi), kExact);
}

TEST(Sensitivity, OfALinearFunctionIsItsSlopesTimesTheRoundings) {
  const QuadFunction f = [](const std::vector<Quad>& in) { return std::vector<Quad>{3 * in[0] - 2 * in[1]}; };
  EXPECT_NEAR(sensitivity(f, {5, 7}, {.125, .25}), 3 * .125 + 2 * .25, 1e-15);
  EXPECT_EQ(sensitivity(f, {5, 7}, {0, 0}), 0);
}

TEST(Sensitivity, RoundingIsOfTheVectorsLength) {
  EXPECT_EQ(rounding({3, 0, 4, .5}, 1, .25), (std::vector<double>{1.25, 1.25, 1.25, .25}));
}

}  // namespace
}  // namespace penumbra::stress
