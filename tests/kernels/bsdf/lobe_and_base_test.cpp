// BSDFs with a lobe and a diffuse base: samples against pdfs, energy, reciprocity, and the limits of their
// ranges.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <ostream>
#include <string>

#include "scenes/bsdfs/diffuse.h"
#include "scenes/bsdfs/microfacet_diffuse.h"
#include "scenes/bsdfs/phong.h"
#include "scenes/bsdfs/plastic.h"
#include "scenes/bsdfs/ward.h"
#include "tests/kernels/bsdf/lobes.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::lobe_and_base_test {
namespace {

using lobes::direction;
using lobes::Lobe;

struct LobeCase {
  std::string name;
  std::function<Lobe()> lobe;
  double most_reflected = 1;  ///< a bound of what any viewer sees of a white sky, beside a mirror; 0: none
};
void PrintTo(const LobeCase& each, std::ostream* out) { *out << each.name; }

const glm::vec3 kBlack(0), kGrey(0.5f), kWhite(1);
template <typename Bsdf>
std::function<Lobe()> of(const Bsdf& bsdf) {
  return [=] { return Lobe(bsdf); };
}
LobeCase ward(const std::string& name, int variant, float u, float v, double most) {
  return {name,
          of(WardBsdf{.variant = variant, .alpha_u = u, .alpha_v = v, .diffuse = {}, .specular = kWhite}),
          most};
}
/// The parameters of Nori's tests.
LobeCase nori(const std::string& name, float alpha, float int_ior, float ext_ior, const glm::vec3& kd) {
  return {name,
          of(MicrofacetDiffuseBsdf{.alpha = alpha, .int_ior = int_ior, .ext_ior = ext_ior, .diffuse = kd})};
}

const LobeCase kLobes[] = {
    {"Plastic", of(PlasticBsdf{})},
    {"PlasticNonlinear", of(PlasticBsdf{.diffuse = glm::vec3(0.9f), .int_ior = 1.9f, .nonlinear = true})},
    {"RoughPlasticGgx", of(RoughPlasticBsdf{.distribution = DISTRIBUTION_GGX, .alpha = 0.15f})},
    {"RoughPlasticGgxWhite",
     of(RoughPlasticBsdf{
         .diffuse = kWhite, .nonlinear = true, .distribution = DISTRIBUTION_GGX, .alpha = 0.6f})},
    {"RoughPlasticBeckmann", of(RoughPlasticBsdf{.alpha = 0.1f})},
    {"RoughPlasticBeckmannBlack", of(RoughPlasticBsdf{.diffuse = kBlack, .alpha = 0.5f})},
    {"PolarizedPlastic", of(PolarizedPlasticBsdf{.alpha = 0.15f})},
    {"PolarizedPlasticGgxWhite",
     of(PolarizedPlasticBsdf{.diffuse = kWhite, .distribution = DISTRIBUTION_GGX, .alpha = 0.4f})},
    {"RoughPlasticInside", of(RoughPlasticBsdf{.int_ior = 1.0f, .ext_ior = 1.3f, .alpha = 0.3f})},
    // Ward's lobes gain at grazing angles, but for the balanced one.
    ward("Ward", WARD_ORIGINAL, 0.15f, 0.4f, 0),
    ward("WardDuer", WARD_DUER, 0.3f, 0.2f, 0),
    ward("WardBalanced", WARD_BALANCED, 0.2f, 0.5f, 1),
    {"WardWithBase", of(WardBsdf{.alpha_u = 0.3f, .alpha_v = 0.1f})},
    {"BlinnPhong0", of(BlinnPhongBsdf{.diffuse = kBlack, .specular = kWhite, .exponent = 0.0f})},
    {"BlinnPhong100", of(BlinnPhongBsdf{.diffuse = kBlack, .specular = kWhite, .exponent = 100.0f})},
    {"BlinnPhongWithBase", of(BlinnPhongBsdf{.diffuse = kGrey, .specular = kGrey, .exponent = 20.0f})},
    {"RoughDiffuse", of(RoughDiffuseBsdf{})},
    // Oren and Nayar's fit of light that is reflected twice adds up to more than arrives at grazing angles.
    {"RoughDiffuseWhite", of(RoughDiffuseBsdf{.reflectance = kWhite, .alpha = 0.7f}), 0},
    {"RoughDiffuseFastWhite",
     of(RoughDiffuseBsdf{.reflectance = kWhite, .alpha = 0.5f, .use_fast_approx = true})},
    nori("NoriNarrow", 0.1f, 1.33f, 1.01f, kBlack),
    nori("NoriMiddle", 0.3f, 1.5f, 1.01f, {0.2f, 0.1f, 0.6f}),
    nori("NoriWide", 0.6f, 1.8f, 1.3f, {0.4f, 0.2f, 0.3f}),
};
const vec3 kViewers[] = {direction(0, 0), direction(0.5, 0.3), direction(1.0, 2.0), direction(1.4, 4.0),
                         direction(std::numbers::pi / 2 - 0.05, 5.5)};
const double kSignificance = statistics::sidak_significance(0.01, std::size(kLobes) * std::size(kViewers));
// Of the rules for the widths above, seen from the viewers above: the narrowest lobe, 0.1 times 0.05 rad wide
// where it is seen at a slant, has two steps of phi in its width.
constexpr double kQuadratureError = 5e-4;

class LobesAndBases : public testing::TestWithParam<LobeCase> {
 protected:
  Lobe lobe_ = GetParam().lobe();
};
INSTANTIATE_TEST_SUITE_P(All, LobesAndBases, testing::ValuesIn(kLobes),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(LobesAndBases, SamplesFollowTheDensityAndReflectWhatTheIntegralSays) {
  constexpr int kSamples = 2500 * lobes::kRows * lobes::kColumns;
  RandomNumbers random(21);
  double most = 0;
  for (const vec3& wo : kViewers) {
    const lobes::Integrals integrals = lobe_.integrals(wo);
    std::vector<double> observed(integrals.density.size());
    double lost = 0, mirrored = 0;
    statistics::Sample weights;  // of what eval finds
    double mirror = 0;
    for (int k = 0; k < kSamples; ++k) {
      const BsdfSample s = lobe_.sample(wo, random.unit_float(), random.unit_float(), random.unit_float());
      if (s.pdf == DELTA_PDF) {
        ++mirrored;
        mirror = double(s.weight.x);
        ASSERT_EQ(s.wi.x, -wo.x);
        ASSERT_EQ(s.wi.z, wo.z);
      } else if (s.pdf > 0) {
        ++observed[lobes::cell_of(s.wi)];
      } else {
        ++lost;
      }
      weights.add(s.pdf > 0 && s.pdf != DELTA_PDF ? double(s.weight.x) : 0);
    }
    // What falls below the horizon is lost, as much as the density lacks of 1.
    const double rest = lost + mirrored;
    EXPECT_NEAR(rest / kSamples, 1 - integrals.total_density,
                kQuadratureError + 5 * std::sqrt(rest) / kSamples);
    std::vector<double> expected = integrals.density;
    for (double& e : expected) e = std::max(e * (kSamples - rest) / integrals.total_density, 1e-3);
    const statistics::TestResult result = statistics::chi_square_test(observed, expected, 5);
    EXPECT_GT(result.p, kSignificance)
        << "viewer at cosine " << wo.z << ": chi^2 " << result.statistic << " with " << result.dof;
    EXPECT_GT(statistics::t_test(weights, integrals.reflectance.x,
                                 kQuadratureError * std::max(1.0, integrals.reflectance.x))
                  .p,
              kSignificance)
        << weights.mean() << " against " << integrals.reflectance.x << " at cosine " << wo.z;
    const double all = integrals.reflectance.x + mirror * mirrored / kSamples;
    most = std::max(most, all);
    if (GetParam().most_reflected > 0) {
      EXPECT_LE(all, GetParam().most_reflected + 2e-3);
    }
  }
  RecordProperty("most_reflected", std::to_string(most));
}

TEST_P(LobesAndBases, AreReciprocal) {
  RandomNumbers random(22);
  for (int k = 0; k < 20'000; ++k) {
    const vec3 wo = direction(std::acos(random.between(1e-3, 1)), random.between(0, 6.28));
    const BsdfSample s = lobe_.sample(wo, random.unit_float(), random.unit_float(), random.unit_float());
    if (!(s.pdf > 0) || s.pdf == DELTA_PDF || s.wi.z < 1e-3f) continue;
    // Next to total reflection, Fresnel's reflectance goes as a square root of the angle.
    const float cosine = 0.5f * length3(add(wo, s.wi)), ior = lobe_.closure().ior;
    if (ior > 0 && std::abs(cosine * cosine + ior * ior - 1) < 0.2f) continue;
    const double there = double(lobe_.eval(wo, s.wi).f_cos.x) / double(s.wi.z);
    const double back = double(lobe_.eval(s.wi, wo).f_cos.x) / double(wo.z);
    // Both have the same half vector: its cosines and the products are rounded, and 1 / cosine stretches
    // that.
    const double rounding = 64 * 0x1p-24 + 16 * 0x1p-24 / double(std::min(wo.z, s.wi.z));
    ASSERT_NEAR(there, back, rounding * back);
  }
}

TEST_P(LobesAndBases, AreOfOneSideAndSampleWhatTheyEvaluate) {
  RandomNumbers random(23);
  for (int k = 0; k < 50'000; ++k) {
    const vec3 wo = rounded(random.direction()), wi = rounded(random.direction());
    const BsdfValue value = lobe_.eval(wo, wi);
    if (wo.z <= 0 || wi.z <= 0) {
      ASSERT_EQ(value.f_cos.x, 0);
      ASSERT_EQ(value.pdf, 0);
    } else {
      ASSERT_GE(value.f_cos.x, 0);
      ASSERT_GE(value.pdf, 0);
    }
    const BsdfSample s = lobe_.sample(wo, random.unit_float(), random.unit_float(), random.unit_float());
    if (wo.z <= 0) {
      ASSERT_EQ(s.pdf, 0);
    }
    if (!(s.pdf > 0) || s.pdf == DELTA_PDF) continue;
    const BsdfValue again = lobe_.eval(wo, s.wi);
    ASSERT_NEAR(s.pdf, again.pdf, 4e-7f * s.pdf);
    ASSERT_NEAR(s.weight.x * s.pdf, again.f_cos.x, 1e-6f * again.f_cos.x);
    ASSERT_NEAR(double(length(exact(s.wi))), 1, 1e-6);
  }
}

/// All of them of that roughness, or of a lobe as narrow.
std::vector<Lobe> of_roughness(float alpha) {
  std::vector<Lobe> all;
  for (const int distribution : {DISTRIBUTION_BECKMANN, DISTRIBUTION_GGX})
    all.emplace_back(RoughPlasticBsdf{.distribution = distribution, .alpha = alpha});
  for (const int variant : {WARD_ORIGINAL, WARD_DUER, WARD_BALANCED})
    all.emplace_back(WardBsdf{.variant = variant, .alpha_u = alpha, .alpha_v = std::sqrt(alpha)});
  all.emplace_back(MicrofacetDiffuseBsdf{.alpha = alpha});
  all.emplace_back(BlinnPhongBsdf{.exponent = 2 / std::max(alpha * alpha, 1e-10f)});
  all.emplace_back(PlasticBsdf{.int_ior = 1 + alpha});
  return all;
}

TEST(LobesAndBasesOfAnyRoughness, HaveFiniteWeights) {
  RandomNumbers random(24);
  for (const float alpha : {0.0f, 1e-4f, 1e-3f, 1e-2f, 0.1f, 1.0f})
    for (const Lobe& lobe : of_roughness(alpha))
      for (const double cosine : {1.0, 0.1, 1e-3, 1e-6, 1e-7})
        for (const float u : {0.0f, 0x1p-24f, 0.3f, 0.99f, ONE_MINUS_EPSILON})
          for (const float v : {0.0f, 0.125f, 0.5f, ONE_MINUS_EPSILON})
            for (const float choice : {0.0f, 0.3f, 0.7f, ONE_MINUS_EPSILON}) {
              const vec3 wo = direction(std::acos(cosine), random.between(0, 6.28));
              const BsdfSample s = lobe.sample(wo, u, v, choice);
              ASSERT_FALSE(std::isnan(s.pdf));
              ASSERT_TRUE(std::isfinite(s.wi.x) && std::isfinite(s.wi.y) && std::isfinite(s.wi.z));
              ASSERT_TRUE(s.weight.x >= 0 && std::isfinite(s.weight.x))
                  << s.weight.x << " for family " << lobe.closure().family << ", roughness " << alpha
                  << ", cosine " << cosine;
              if (s.pdf == DELTA_PDF || !(s.pdf > 0)) continue;
              ASSERT_TRUE(std::isfinite(s.pdf) && s.wi.z > 0);
            }
}

TEST(RoughDiffuse, WithoutSlopesIsLambertian) {
  for (const bool is_fast : {false, true}) {
    const Lobe lobe(RoughDiffuseBsdf{.reflectance = kGrey, .alpha = 0.0f, .use_fast_approx = is_fast});
    const vec3 wi = direction(0.7, 1);
    EXPECT_EQ(lobe.eval(direction(1.1, 2), wi).f_cos.x, 0.5f * (wi.z * INV_PI_F));
  }
}

TEST(RoughDiffuse, TheFastModelReflectsWhatItsIntegralSays) {
  // pi f = A + B max(0, cos phi) sin(high) tan(low): over phi the cosine integrates to 2, and over theta the
  // rest is elementary on either side of the viewer's angle.
  const double sigma2 = 0.5 * 0.6 * 0.6, a = 1 - 0.5 * sigma2 / (sigma2 + 0.33),
               b = 0.45 * sigma2 / (sigma2 + 0.09);
  const Lobe lobe(RoughDiffuseBsdf{.reflectance = kWhite, .alpha = 0.6f, .use_fast_approx = true});
  for (const double theta : {0.0, 0.2, 0.7, 1.1, 1.4, 1.55}) {
    const double sine = std::sin(theta), cosine = std::cos(theta);
    const double rest = sine * (theta - sine * cosine) / 2 + sine / cosine * (1 - sine * sine * sine) / 3;
    EXPECT_NEAR(lobe.reflectance(direction(theta, 1)).x, a + b * rest * 2 / std::numbers::pi, 1e-4) << theta;
  }
}

TEST(RoughDiffuse, IsWhatTheFormulasSay) {
  // Oren and Nayar's angles and tangents as they stand, in double.
  constexpr double kPi = std::numbers::pi, kAlpha = 0.45, kReflectance = 0.8;
  const double sigma2 = kAlpha * kAlpha / 2;
  const Lobe lobe(RoughDiffuseBsdf{.reflectance = glm::vec3(float(kReflectance)), .alpha = float(kAlpha)});
  RandomNumbers random(26);
  for (int k = 0; k < 1000; ++k) {
    const double theta_o = random.between(0, 1.5), theta_i = random.between(0, 1.5);
    const double phi = random.between(0, 2 * kPi), cosine = std::cos(phi);
    const double high = std::max(theta_o, theta_i), low = std::min(theta_o, theta_i);
    const double c1 = 1 - 0.5 * sigma2 / (sigma2 + 0.33);
    const double c2 =
        0.45 * sigma2 / (sigma2 + 0.09) * (std::sin(high) - (cosine < 0 ? std::pow(2 * low / kPi, 3) : 0));
    const double c3 = 0.125 * sigma2 / (sigma2 + 0.09) * std::pow(4 * high * low / (kPi * kPi), 2);
    const double once =
        c1 + cosine * c2 * std::tan(low) + (1 - std::abs(cosine)) * c3 * std::tan((high + low) / 2);
    const double twice = 0.17 * sigma2 / (sigma2 + 0.13) * (1 - cosine * std::pow(2 * low / kPi, 2));
    const double expected = kReflectance / kPi * (once + kReflectance * twice) * std::cos(theta_i);
    // The terms are rounded, and cosines next to the horizon more.
    ASSERT_NEAR(double(lobe.eval(direction(theta_o, 0.4), direction(theta_i, 0.4 + phi)).f_cos.x), expected,
                1e-5 * kReflectance);
  }
}

TEST(BlinnPhong, OfExponent0IsLambertian) {
  const Lobe lobe(BlinnPhongBsdf{.diffuse = kBlack, .specular = kGrey, .exponent = 0.0f});
  const vec3 wi = direction(0.7, 1);
  EXPECT_NEAR(lobe.eval(direction(1.1, 2), wi).f_cos.x, 0.5f * INV_PI_F * wi.z, 1e-7f);
}

TEST(BlinnPhong, ReflectsItsReflectanceAlongTheNormal) {
  for (const float exponent : {0.0f, 1.0f, 10.0f, 100.0f, 300.0f}) {
    const Lobe lobe(BlinnPhongBsdf{.diffuse = kBlack, .specular = kGrey, .exponent = exponent});
    EXPECT_NEAR(lobe.reflectance(direction(0, 0)).x, 0.5, 1e-4) << exponent;
  }
}

TEST(WardLobe, IsWhatTheFormulasSay) {
  // Mitsuba 0.6's formulas as they stand, in double.
  const double au = 0.3, av = 0.12;
  RandomNumbers random(25);
  for (const int variant : {WARD_ORIGINAL, WARD_DUER, WARD_BALANCED}) {
    const Lobe lobe(WardBsdf{.variant = variant,
                             .alpha_u = float(au),
                             .alpha_v = float(av),
                             .diffuse = kBlack,
                             .specular = kGrey});
    for (int k = 0; k < 1000; ++k) {
      const vec3 wo = direction(random.between(0, 1.4), random.between(0, 6.28));
      const vec3 wi = lobe.sample(wo, random.unit_float(), random.unit_float(), 0).wi;
      if (wi.z < 0.05f) continue;
      const double x = double(wo.x) + double(wi.x), y = double(wo.y) + double(wi.y);
      const double z = double(wo.z) + double(wi.z), cosines = double(wo.z) * double(wi.z);
      const double power = std::exp(-(x * x / (au * au) + y * y / (av * av)) / (z * z));
      const double factor = variant == WARD_ORIGINAL ? 1 / (4 * std::sqrt(cosines))
                            : variant == WARD_DUER   ? 1 / (4 * cosines)
                                                     : (x * x + y * y + z * z) / std::pow(z, 4);
      const double expected = 0.5 * factor * power / (std::numbers::pi * au * av) * double(wi.z);
      ASSERT_NEAR(double(lobe.eval(wo, wi).f_cos.x), expected, 2e-5 * expected);
    }
  }
}

}  // namespace
}  // namespace penumbra::lobe_and_base_test
