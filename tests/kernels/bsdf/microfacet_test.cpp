// Microfacets and Fresnel's equations against independent formulas in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "tests/kernels/bsdf/bsdf_cases.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::microfacet_test {
namespace {

constexpr double kPi = std::numbers::pi;

vec3 direction(double theta, double phi) {
  return make_vec3(float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
                   float(std::cos(theta)));
}
const vec3 kNormal = make_vec3(0, 0, 1);

// --- the model, by the angles of Walter et al. 2007 and the slopes of Heitz 2014

struct Truth {
  bool ggx;
  double u, v;  ///< roughness

  [[nodiscard]] double density(const Exact3& h) const {
    const double x = double(h.x / h.z) / u, y = double(h.y / h.z) / v, cos4 = std::pow(double(h.z), 4);
    const double q = x * x + y * y;
    return (ggx ? 1 / ((1 + q) * (1 + q)) : std::exp(-q)) / (kPi * u * v * cos4);
  }
  /// 1 / a: the tangent of the direction times the roughness in it.
  [[nodiscard]] double slope(const Exact3& w) const {
    return std::hypot(u * double(w.x), v * double(w.y)) / std::abs(double(w.z));
  }
  /// 1 / (1 + Lambda).
  [[nodiscard]] double exact_masking(const Exact3& w) const {
    const double t = slope(w), a = 1 / t;
    if (t == 0) return 1;
    const double lambda = ggx ? (std::sqrt(1 + t * t) - 1) / 2
                              : (std::erf(a) - 1) / 2 + std::exp(-a * a) / (2 * a * std::sqrt(kPi));
    return 1 / (1 + lambda);
  }
  [[nodiscard]] double masking(const Exact3& w) const {
    const double a = 1 / slope(w);
    if (ggx) return exact_masking(w);
    return a < 1.6 ? (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a) : 1;
  }
};

/// By complex amplitudes, the refracted cosine from Snell's law.
double fresnel(double cosine, std::complex<double> index) {
  const std::complex<double> sine2 = (1 - cosine * cosine) / (index * index), other = std::sqrt(1.0 - sine2);
  const std::complex<double> s = (cosine - index * other) / (cosine + index * other),
                             p = (index * cosine - other) / (index * cosine + other);
  return 0.5 * (std::norm(s) + std::norm(p));
}

TEST(Fresnel, OfConductorsIsThatOfComplexAmplitudes) {
  RandomNumbers random(1);
  // Amplitudes are differences of numbers of their rounding.
  for (int k = 0; k < 100'000; ++k) {
    const double cosine = std::pow(10.0, random.between(-6, 0));
    const auto eta = float(std::pow(10.0, random.between(-2, 1))),
               kappa = float(std::pow(10.0, random.between(-3, 1)));
    const double truth = fresnel(float(cosine), {eta, -kappa});
    // Their inner cosine is the root of a difference, next to 0 where light grazes inside too.
    const std::complex<double> index(eta, -kappa), square = index * index - (1 - cosine * cosine);
    const double off = 4 * 0x1p-24 * (std::norm(index) + 1) / (2 * std::sqrt(std::abs(square)));
    ASSERT_NEAR(conductor_reflectance(float(cosine), eta, kappa), truth,
                2e-6 * truth + (8 * 0x1p-24 + 4 * std::min(off, 1e-3)) * std::sqrt(truth))
        << eta << " " << kappa << " " << cosine;
  }
  // From above ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2): gold at 532 nm, and a perfect mirror.
  EXPECT_NEAR(conductor_reflectance(1, 0.544f, 2.1966f),
              (0.456 * 0.456 + 2.1966 * 2.1966) / (1.544 * 1.544 + 2.1966 * 2.1966), 1e-6);
  for (float cosine : {0.0f, 1e-6f, 0.3f, 1.0f}) EXPECT_EQ(conductor_reflectance(cosine, 0, 1), 1);
  for (float eta : {0.0f, 1.0f, 1e4f})
    for (float kappa : {0.0f, 1e4f})
      for (float cosine : {0.0f, 1e-30f, 1e-6f, 1.0f}) {
        const float r = conductor_reflectance(cosine, eta, kappa);
        EXPECT_TRUE(r >= 0 && r <= 1) << eta << " " << kappa << " " << cosine << ": " << r;
      }
}

TEST(Fresnel, OfDielectricsIsExactAtAnyAngleAndNextToOne) {
  RandomNumbers random(2);
  for (int k = 0; k < 200'000; ++k) {
    const float cosine = float(std::pow(10.0, random.between(-6, 0)));
    const double step = std::pow(10.0, random.between(-7, 0.2)) * (random.below(2) == 0 ? 1 : -0.45);
    const float ior = float(1 + step);
    if (ior == 1) continue;
    // In terms of cosines, with extended precision: c and n t where both are close.
    const long double c = cosine, n = ior, t2 = 1 - (1 - c * c) / (n * n);
    const DielectricFresnel f = dielectric_fresnel(cosine, ior);
    // The refracted cosine is a difference, whose error is that of its terms.
    const double off = 4 * 0x1p-24 * double((c * c + std::abs(n * n - 1)) / (n * n) + std::abs(t2));
    if (std::abs(double(t2)) < 100 * off) continue;
    if (t2 < 0) {
      ASSERT_EQ(f.reflectance, 1);
      continue;
    }
    const long double t = std::sqrt(t2), s = (c - n * t) / (c + n * t), p = (n * c - t) / (n * c + t);
    const double truth = double(0.5L * (s * s + p * p));
    ASSERT_NEAR(double(f.cosine) * f.cosine, double(t2), off);
    // Both amplitudes change with t by at most 4 n / (sum).
    const double by_cosine =
        8 * off / (2 * double(t)) / double(std::min(c + n * t, n * c + t)) * std::sqrt(truth);
    ASSERT_NEAR(f.reflectance, truth, 4e-6 * truth + by_cosine) << cosine << " " << ior;
  }
  for (float cosine : {0.0f, 1e-6f, 0.5f, 1.0f})
    EXPECT_EQ(dielectric_fresnel(cosine, 1).reflectance, 0) << cosine;
  EXPECT_NEAR(dielectric_fresnel(1, 1.5f).reflectance, 0.04, 1e-8);
  EXPECT_NEAR(dielectric_fresnel(0, 1.5f).reflectance, 1, 1e-6);
  // Brewster's angle, tan = n: the mean of the other polarisation alone, ((n^2 - 1) / (n^2 + 1))^2 / 2.
  EXPECT_NEAR(dielectric_fresnel(float(1 / std::sqrt(1 + 2.25)), 1.5f).reflectance,
              0.5 * std::pow(1.25 / 3.25, 2), 1e-7);
}

TEST(SmoothBsdfs, KeepAllOfTheEnergyAndChooseByFresnel) {
  for (double ior : {1.5, 1 / 1.5, 2.4, 1 + 1e-7, 1 - 1e-7, 1.0})
    for (double theta : {0.0, 0.4, 0.8, 1.2, 1.5}) {
      const Closure c = smooth_case("", FAMILY_DIELECTRIC, ior).closure();
      const vec3 wo = direction(theta, 2);
      const float chance = dielectric_lobe_probability(c, wo);
      const BsdfSample through = dielectric_sample(nullptr, c, wo, 0, 0, ONE_MINUS_EPSILON);
      EXPECT_NEAR(chance, ior == 1 ? 0 : fresnel(wo.z, c.ior), 3e-7);
      if (chance > 0) {
        const BsdfSample mirrored = dielectric_sample(nullptr, c, wo, 0, 0, 0);
        EXPECT_EQ(mirrored.wi.x, -wo.x);
        EXPECT_EQ(mirrored.wi.z, wo.z);
        EXPECT_EQ(mirrored.weight.x, 1);
        EXPECT_EQ(mirrored.eta, 1);
      }
      if (chance < 1) {
        // Snell, in the plane of incidence; and the square of the index is what radiance gains.
        EXPECT_NEAR(through.wi.x * ior, -wo.x, 1e-6);
        EXPECT_NEAR(through.wi.y * ior, -wo.y, 1e-6);
        EXPECT_LT(through.wi.z, 0);
        EXPECT_NEAR(double(length(exact(through.wi))), 1, 1e-6);
        EXPECT_EQ(through.eta, c.ior);
        EXPECT_NEAR(through.weight.x * ior * ior, 1, 1e-6);
      }
      // A thin pane: what is reflected once, thrice, five times within it.
      const Closure pane = smooth_case("", FAMILY_THINDIELECTRIC, ior).closure();
      const double r = chance;
      double sum = r, inside = (1 - r) * (1 - r) * r;
      for (int k = 0; k < 2000; ++k, inside *= r * r) sum += inside;
      EXPECT_NEAR(thindielectric_lobe_probability(pane, wo), std::min(sum, 1.0), 1e-4);
    }
}

class MicrofacetCases : public testing::TestWithParam<BsdfCase> {
 protected:
  Closure closure_ = GetParam().closure();
  Truth truth_{GetParam().is_ggx(), closure_.alpha_u, closure_.alpha_v};
  Microfacets microfacets_ = make_microfacets(truth_.ggx ? DISTRIBUTION_GGX : DISTRIBUTION_BECKMANN,
                                              closure_.alpha_u, closure_.alpha_v);
};
INSTANTIATE_TEST_SUITE_P(All, MicrofacetCases, testing::ValuesIn(bsdf_cases_of([](const BsdfCase& c) {
                           return (((ROUGH_CONDUCTORS | ROUGH_DIELECTRICS) >> c.material().family) & 1u) !=
                                  0u;
                         })),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(MicrofacetCases, DensityAndMaskingAreThoseOfTheModel) {
  RandomNumbers random(3);
  for (int k = 0; k < 50'000; ++k) {
    // Slopes of up to 4 times the roughness, and directions down to the horizon.
    const double around = 2 * kPi * random.uniform(), q = 4 * random.uniform();
    const Exact3 slopes = {-q * truth_.u * std::cos(around), -q * truth_.v * std::sin(around), 1};
    const vec3 h = rounded(normalize(slopes));
    const double density = truth_.density(exact(h));
    // Rounding of the logarithm, -q^2, or of four roundings of the sum.
    ASSERT_NEAR(microfacet_density(microfacets_, h), density, (4e-7 * q * q + 3e-6) * density);
    const vec3 w = direction(std::acos(std::pow(10.0, random.between(-6, 0))), around);
    if (!(w.z > 0)) continue;
    ASSERT_NEAR(microfacet_masking(microfacets_, w), truth_.masking(exact(w)),
                2e-6 * truth_.masking(exact(w)));
    const double exact_one = truth_.exact_masking(exact(w));
    ASSERT_NEAR(microfacet_visible_over_cosine(microfacets_, w) * w.z, exact_one, 2e-6 * exact_one);
    ASSERT_NEAR(truth_.masking(exact(w)) / exact_one, 1, 0.0035);
  }
}

TEST_P(MicrofacetCases, ValuesAreThoseOfTheModel) {
  // f cos of Walter et al., equations 20 and 21, and radiance over the square of the index.
  RandomNumbers random(4);
  const double ior = GetParam().has(TRANSMITS) ? closure_.ior : 0;
  int compared = 0;
  for (int k = 0; k < 20'000; ++k) {
    const vec3 wo = direction(std::acos(random.between(0.02, 1)), 2 * kPi * random.uniform());
    const BsdfSample s = sample_bsdf(nullptr, closure_, kNormal, wo, random.unit_float(), random.unit_float(),
                                     random.unit_float());
    if (!(s.pdf > 0) || std::abs(s.wi.z) < 0.02f) continue;
    const bool through = s.wi.z < 0;
    const Exact3 o = exact(wo), i = exact(s.wi);
    Exact3 h = normalize(through ? -1 * (o + ior * i) : o + i);
    if (h.z < 0) h = -1 * h;
    // Where rounding of the directions turns the normal by less than a hundredth of its roughness.
    const double least = std::min(truth_.u, truth_.v);
    const double turned =
        4 * 0x1p-24 * (1 + (through ? ior : 1)) / double(length(through ? o + ior * i : o + i));
    const double slope = std::hypot(double(h.x / h.z), double(h.y / h.z));
    const double off =
        turned * (1 + slope * slope) * (truth_.ggx ? 2 / least : 2 * slope / (least * least) + 1 / least);
    if (off > 0.01) continue;
    const double ho = std::abs(double(dot(h, o))), hi = std::abs(double(dot(h, i)));
    const double geometry = truth_.density(h) * truth_.masking(o) * truth_.masking(i);
    for (int channel = 0; channel < (ior > 0 ? 1 : 3); ++channel) {
      const float eta[] = {closure_.eta.x, closure_.eta.y, closure_.eta.z};
      const float kappa[] = {closure_.k.x, closure_.k.y, closure_.k.z};
      const double f = ior > 0 ? fresnel(ho, ior) : fresnel(ho, {eta[channel], -kappa[channel]});
      // Fresnel next to the critical angle: see bsdf_test.cpp.
      const double square = ior > 0 ? std::abs(1 - (1 - ho * ho) / (ior * ior)) : 1;
      const double error = ior > 0 ? 8 * 0x1p-24 * (1 + 1 / (ior * ior)) : 0;
      const double by_fresnel = through ? error / square : 4 * error / std::sqrt(square);
      if (by_fresnel > 0.01) continue;
      const double sum = double(dot(h, o)) + ior * double(dot(h, i));
      const double expected =
          through ? ho * hi * (1 - f) * geometry / (wo.z * sum * sum) : f * geometry / (4 * wo.z);
      const BsdfValue value = eval_bsdf(nullptr, closure_, kNormal, wo, s.wi);
      const float seen[] = {value.f_cos.x, value.f_cos.y, value.f_cos.z};
      ASSERT_NEAR(seen[channel], expected, (2e-5 + 4 * off + by_fresnel) * expected) << wo.z << " " << s.wi.z;
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST_P(MicrofacetCases, VisibleNormalsFollowTheirDistributionHoweverNarrow) {
  // Their slopes along the viewer's stretched direction and across it, by conditional distribution functions.
  constexpr int kSide = 20, kSamples = 400'000;
  RandomNumbers random(15);
  std::vector<double> ps;
  for (double theta : {0.0, 0.5, 1.2, 1.55, kPi / 2 - 1e-4}) {
    const vec3 wo = direction(theta, 1.0);
    const Exact3 o = exact(wo);
    const double sx = truth_.u * double(o.x), sy = truth_.v * double(o.y), slant = std::hypot(sx, sy);
    const double c = double(o.z) / std::max(slant, 1e-12);  // cotangent of the stretched viewer
    const double ax = slant > 0 ? sx / slant : 1, ay = slant > 0 ? sy / slant : 0;
    std::vector<double> counts(kSide * kSide);
    for (int k = 0; k < kSamples; ++k) {
      const Exact3 h = exact(sample_microfacet(microfacets_, wo, random.unit_float(), random.unit_float()));
      ASSERT_GT(double(h.z), 0);
      const double x = -double(h.x / h.z) / truth_.u, y = -double(h.y / h.z) / truth_.v;
      const double along = x * ax + y * ay, across = y * ax - x * ay;
      double first, second;
      if (truth_.ggx) {
        // Mirror the stretched viewer about the unstretched normal: uniform on a cap of the sphere.
        const double norm = std::sqrt(1 + c * c), vx = 1 / norm, vz = c / norm;
        const double length = std::sqrt(1 + along * along + across * across);
        const Exact3 n = {-along / length, -across / length, 1 / length}, v = {vx, 0, vz};
        const Exact3 mirrored = (2 * dot(n, v)) * n - v;
        first = 1 - (double(mirrored.z) + vz) / (1 + vz);
        second = std::atan2(double(mirrored.y), double(mirrored.x)) / (2 * kPi);
        if (second < 0) second += 1;
      } else {
        // Along: density in proportion to (c - x) exp(-x^2) below c; across it is a Gaussian.
        const auto cdf = [&](double t) { return c * std::erfc(-t) + std::exp(-t * t) / std::sqrt(kPi); };
        first = cdf(std::min(along, c)) / cdf(c);
        second = 0.5 * std::erfc(-across);
      }
      const auto cell = [](double p) { return std::size_t(std::clamp(p, 0.0, 1 - 1e-12) * kSide); };
      ++counts[cell(first) * kSide + cell(second)];
    }
    ps.push_back(statistics::chi_square_test(
                     counts, std::vector<double>(counts.size(), double(kSamples) / (kSide * kSide)))
                     .p);
  }
  for (double p : ps) EXPECT_GT(p, statistics::sidak_significance(0.01, 30 * ps.size()));
}

TEST(Microfacets, RoughnessHasAFloorAndACeiling) {
  const Microfacets least = make_microfacets(DISTRIBUTION_GGX, 0, -1), most = make_microfacets(0, 1e30f, NAN);
  EXPECT_EQ(least.alpha_u, LEAST_ALPHA);
  EXPECT_EQ(least.alpha_v, LEAST_ALPHA);
  EXPECT_EQ(most.alpha_u, MOST_ALPHA);
  EXPECT_EQ(most.alpha_v, LEAST_ALPHA);
}

}  // namespace
}  // namespace penumbra::microfacet_test
