// Hair: the parts that its values are products of, energy, and values of Mitsuba 3.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "kernels/host/device_scene.h"
#include "tests/kernels/bsdf/hair_cases.h"
#include "tests/kernels/bsdf/mitsuba_values.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra::hair_test {
namespace {

constexpr double kPi = std::numbers::pi;
const vec3 kNormal = make_vec3(0, 0, 1);

/// At an inclination to the plane across a fibre along x, and an azimuth in that plane.
vec3 at_inclination(double theta, double phi) {
  return make_vec3(float(std::sin(theta)), float(std::cos(theta) * std::cos(phi)),
                   float(std::cos(theta) * std::sin(phi)));
}

/// e^-x I0(x) by the mean of e^(x (cos a - 1)), which the midpoint rule has to rounding.
double bessel_oracle(double x) {
  constexpr int kParts = 100'000;
  double sum = 0;
  for (int i = 0; i < kParts; ++i) sum += std::exp(x * (std::cos(kPi * (i + 0.5) / kParts) - 1));
  return sum / kParts;
}

TEST(Hair, BesselFunction) {
  for (const double x : {0.0, 1e-3, 0.5, 2.0, 3.7, 3.8, 10.0, 100.0, 1e4, 1e6}) {
    const double exact = bessel_oracle(double(float(x)));
    EXPECT_NEAR(double(scaled_bessel_i0(float(x))) / exact, 1, 1e-6) << x;
  }
}

TEST(Hair, LongitudinalPartIsADensityAtAnyRoughness) {
  // Midpoint rule, with 20 points a standard deviation where the lobe is narrow.
  for (const double variance : {1e-5, 1e-4, 1e-3, 0.03, 0.5, 10.0, 100.0})
    for (const double theta_o : {0.0, 0.4, -1.2, 1.55}) {
      const double step = std::min(0.05 * std::sqrt(variance), 1e-3);
      const int parts = int(std::ceil(kPi / step));
      double sum = 0;
      for (int i = 0; i < parts; ++i) {
        const double theta = -kPi / 2 + kPi * (i + 0.5) / parts;
        sum += std::cos(theta) * kPi / parts *
               double(hair_longitudinal(float(std::sin(theta)), float(std::cos(theta)),
                                        float(std::sin(theta_o)), float(std::cos(theta_o)), float(variance)));
      }
      // The cosine has an edge at the poles, where the lobe is at most 1 / v: step^2 / (24 v). Sines and
      // cosines are rounded to 2^-24, their distance is a standard deviation.
      EXPECT_NEAR(sum, 1, 2 * 0.05 * 0.05 / 24 + 4 * 0x1p-24 / std::sqrt(variance))
          << variance << " at " << theta_o;
    }
}

TEST(Hair, AzimuthalPartIsADensityAndIsSampledByItsInverse) {
  for (const float s : {2e-3f, 0.03f, 0.2f, 1.0f, 4.0f}) {
    const double step = std::min(0.05 * double(s), 0.002);
    const int parts = int(std::ceil(2 * kPi / step));
    double sum = 0;
    std::vector<double> below;
    for (int i = 0; i < parts; ++i) {
      below.push_back(sum);
      sum += 2 * kPi / parts * double(hair_azimuthal(float(-kPi + 2 * kPi * (i + 0.5) / parts), s));
    }
    EXPECT_NEAR(sum, 1, 1e-4) << s;  // (step / s)^2 / 24, and rounding of the angle
    for (const double u : {0.001, 0.2, 0.5, 0.9, 0.999}) {
      const double x = double(hair_sample_azimuthal(float(u), s));
      const double at = (x + kPi) / (2 * kPi) * parts;
      const auto i = std::size_t(std::clamp(at, 0.0, double(parts - 2)));
      EXPECT_NEAR(std::lerp(below[i], below[i + 1], at - double(i)), u, 2e-4) << s;
    }
  }
}

TEST(Hair, ReflectsAllThatArrivesIfItAbsorbsNothing) {
  constexpr int kThetas = 192, kPhis = 192;
  // The midpoint rule, for the edge of the cosine at a pole that is d away: step^2 / 24 times the lobe there,
  // which is at most exp(-d^2 / (2 v)) / v <= 2 / (e d^2). The tilt of TRT leaves d of 0.23.
  constexpr double kStep = kPi / kThetas,
                   kError = 2 * kStep * kStep / 24 * 2 / (std::numbers::e * 0.23 * 0.23);
  for (const double beta_m : {0.1, 0.4, 1.0})
    for (const double beta_n : {0.15, 0.5, 1.0})
      for (const double h : {-0.97, 0.0, 0.6})
        for (const double theta : {-1.2, 0.0, 0.7}) {
          Closure c = hair_case("", beta_m, beta_n, 0, HAIR_OFFSET_BY_V).closure();
          c.offset = float(h);
          const vec3 wo = at_inclination(theta, 1.1);
          double sum = 0;
          for (int i = 0; i < kThetas; ++i)
            for (int j = 0; j < kPhis; ++j) {
              const double at = -kPi / 2 + kPi * (i + 0.5) / kThetas;
              const vec3 wi = at_inclination(at, 2 * kPi * (j + 0.5) / kPhis);
              sum += double(hair_eval(nullptr, c, wo, wi).f_cos.x) * std::cos(at);
            }
          EXPECT_NEAR(sum * kPi / kThetas * 2 * kPi / kPhis, 1, kError)
              << beta_m << ' ' << beta_n << ' ' << h << ' ' << theta;
        }
}

TEST(Hair, WeightsOfSamplesAreWhatIsNotAbsorbed) {
  // A fibre without absorption passes all on in each sample, since its lobes are sampled as they are; to some
  // ten roundings.
  RandomNumbers random(3);
  for (const double beta : {0.0, 0.05, 0.3, 1.0}) {
    Closure c = hair_case("", beta, beta, 0, HAIR_ALONG_V).closure();
    for (int k = 0; k < 20'000; ++k) {
      const vec3 wo = sample_cosine_hemisphere(kNormal, random.unit_float(), random.unit_float());
      const BsdfSample s =
          hair_sample(nullptr, c, wo, random.unit_float(), random.unit_float(), random.unit_float());
      if (s.pdf > 0) ASSERT_NEAR(s.weight.x, 1, 2e-6) << beta << " from " << wo.z;
    }
  }
}

TEST(Hair, OffsetsByTheNormalAndByTheTextureAreAlike) {
  // A tube around the x axis, seen along -z: its normal leans to the side of the offset, which is that of the
  // y axis of the frame of a ribbon.
  const Closure tube = hair_case("", 0.3, 0.4, 0.3, 0).closure();
  Closure ribbon = hair_case("", 0.3, 0.4, 0.3, HAIR_OFFSET_BY_V).closure();
  RandomNumbers random(4);
  for (int k = 0; k < 1000; ++k) {
    const double h = random.between(-0.95, 0.95), cosine = std::sqrt(1 - h * h);
    ribbon.offset = float(h);
    const double theta = random.between(-1, 1);
    const vec3 wo = at_inclination(theta, kPi / 2), wi = rounded(random.direction());
    const auto on_tube = [&](const vec3& w) {
      return make_vec3(w.x, float(cosine * double(w.y) - h * double(w.z)),
                       float(h * double(w.y) + cosine * double(w.z)));
    };
    const float expected = hair_eval(nullptr, ribbon, wo, wi).f_cos.x;
    // Rounding of the offset, over the cosine, times the slope of the azimuthal part.
    ASSERT_NEAR(hair_eval(nullptr, tube, on_tube(wo), on_tube(wi)).f_cos.x, expected, 1e-4 * expected);
  }
}

TEST(Hair, AbsorptionOfAColourGivesThatColour) {
  // Chiang et al., equation 9, and back.
  for (const float beta_n : {0.1f, 0.3f, 1.0f})
    for (const float colour : {0.01f, 0.5f, 0.99f, 1.0f}) {
      const float factor = hair_colour_factor(beta_n);
      const double sigma = double(hair_absorption_of(colour, factor));
      EXPECT_NEAR(std::exp(-std::sqrt(sigma) * double(factor)), double(colour), 1e-5);
    }
}

TEST(Hair, IsWorthWhatMitsubaSays) {
  const std::vector<MitsubaBsdf> bsdfs = mitsuba_bsdfs("hair_values.txt");
  ASSERT_EQ(bsdfs.size(), 7u);
  for (const MitsubaBsdf& bsdf : bsdfs) {
    const Closure c = closure_of(material_of(std::get<HairBsdf>(model_of(bsdf.xml))));
    EXPECT_EQ(bsdf.values.size(), 18u);
    // Mitsuba's I0(x) is ten terms of its series, which up to x = 12 lack 2 % at most and below 4 nothing;
    // and from there on e^x / sqrt(2 pi x) with half of the term 1 / (8 x).
    constexpr double kRounding = 2e-4;
    const double lacking = c.alpha_u >= 0.9f ? 0 : 0.021;
    for (const MitsubaValue& v : bsdf.values) {
      const BsdfValue ours = eval_bsdf(nullptr, c, kNormal, v.wo, v.wi);
      const auto close = [&](float a, float b) {
        if (b < 1e-30f) return;  // Mitsuba's own exponentials are 0
        const double ratio = double(a) / double(b);
        EXPECT_TRUE(ratio > 1 - kRounding && ratio < 1 + kRounding + lacking)
            << ratio << " of " << bsdf.xml << " viewer " << v.wo.x << ' ' << v.wo.y << ' ' << v.wo.z
            << " light " << v.wi.x << ' ' << v.wi.y << ' ' << v.wi.z;
      };
      close(ours.f_cos.x, v.f_cos.x);
      close(ours.f_cos.y, v.f_cos.y);
      close(ours.f_cos.z, v.f_cos.z);
      close(ours.pdf, v.pdf);
    }
  }
}

}  // namespace
}  // namespace penumbra::hair_test
