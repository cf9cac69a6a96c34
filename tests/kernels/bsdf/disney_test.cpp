// Disney's BRDF and the lobes of the principled BSDFs against their papers' formulas in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "kernels/host/device_scene.h"
#include "scenes/bsdfs.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::disney_test {
namespace {

constexpr double kPi = std::numbers::pi;
using Rgb = std::array<double, 3>;

/// Burley 2012 as he writes it, with N = z, X = x, Y = y; G of the main lobe after the revision of 2014.
struct Paper {
  const DisneyBsdf& m;
  Exact3 L, V;
  Rgb f{};
  double per_cosine = 0;  ///< by how much f may change as the cosine of L and the half vector does

  static double schlick(double u) { return std::pow(std::clamp(1 - u, 0.0, 1.0), 5); }
  static double between(double a, double b, double t) { return (1 - t) * a + t * b; }
  static double gtr1(double n_h, double a) {
    const double a2 = a * a, t = 1 + (a2 - 1) * n_h * n_h;
    return (a2 - 1) / (kPi * std::log(a2) * t);
  }
  static double gtr2(const Exact3& h, double ax, double ay) {
    const double x = double(h.x) / ax, y = double(h.y) / ay, t = x * x + y * y + double(h.z * h.z);
    return 1 / (kPi * ax * ay * t * t);
  }
  /// G1 / (2 N.w).
  static double masking(const Exact3& w, double ax, double ay) {
    const double x = double(w.x) * ax, y = double(w.y) * ay, z = double(w.z);
    return 1 / (z + std::sqrt(x * x + y * y + z * z));
  }

  Paper(const DisneyBsdf& bsdf, const Exact3& light, const Exact3& viewer) : m(bsdf), L(light), V(viewer) {
    const Exact3 h = normalize(L + V);
    const double n_l = double(L.z), n_v = double(V.z), l_h = double(dot(L, h));
    const double fl = schlick(n_l), fv = schlick(n_v), fh = schlick(l_h);
    const double rough = m.roughness.value, metallic = m.metallic.value;
    const double fd90 = 0.5 + 2 * l_h * l_h * rough, fd = between(1, fd90, fl) * between(1, fd90, fv);
    const double fss90 = l_h * l_h * rough, fss = between(1, fss90, fl) * between(1, fss90, fv);
    const double ss = 1.25 * (fss * (1 / (n_l + n_v) - 0.5) + 0.5);
    const double aspect = std::sqrt(1 - 0.9 * m.anisotropic.value);
    const double ax = std::max(1e-3, rough * rough / aspect), ay = std::max(1e-3, rough * rough * aspect);
    const double ds = gtr2(h, ax, ay), gs = masking(L, ax, ay) * masking(V, ax, ay);
    const double dr = gtr1(double(h.z), between(0.1, 0.001, m.clearcoat_gloss.value));
    const double fr = between(0.04, 1, fh), gr = masking(L, 0.25, 0.25) * masking(V, 0.25, 0.25);
    const Rgb colour = {m.base_color.value.x, m.base_color.value.y, m.base_color.value.z};
    const double luminance = 0.3 * colour[0] + 0.6 * colour[1] + 0.1 * colour[2];
    for (std::size_t i = 0; i < 3; ++i) {
      const double tint = luminance > 0 ? colour[i] / luminance : 1;
      const double plain = m.specular.value * 0.08 * between(1, tint, m.specular_tint.value);
      const double fs = between(between(plain, colour[i], metallic), 1, fh);
      const double sheen = fh * m.sheen.value * between(1, tint, m.sheen_tint.value);
      f[i] = (between(fd, ss, m.subsurface.value) * colour[i] / kPi + sheen) * (1 - metallic) + gs * fs * ds +
             0.25 * m.clearcoat.value * gr * fr * dr;
    }
    per_cosine = 5 * std::pow(1 - l_h, 4) * (m.sheen.value + gs * ds + m.clearcoat.value * gr * dr);
  }
};

DisneyBsdf random_disney(RandomNumbers& random) {
  // Ends of the ranges as often as not.
  const auto number = [&] {
    const double kind = random.between(0, 4);
    return kind < 1 ? 0.0f : kind < 2 ? 1.0f : random.unit_float();
  };
  DisneyBsdf m;
  m.base_color = glm::vec3(number(), number(), number());
  for (TexturedNumber* each : {&m.subsurface, &m.metallic, &m.specular, &m.specular_tint, &m.roughness,
                               &m.anisotropic, &m.sheen, &m.sheen_tint, &m.clearcoat, &m.clearcoat_gloss})
    *each = number();
  return m;
}

TEST(DisneyBrdf, IsThatOfThePaper) {
  RandomNumbers random(31);
  int lit = 0;
  for (int k = 0; k < 20'000; ++k) {
    const DisneyBsdf m = random_disney(random);
    const Closure c = closure_of(material_of(m));
    const vec3 wo = sample_cosine_hemisphere(make_vec3(0, 0, 1), random.unit_float(), random.unit_float());
    if (wo.z < 1e-3f) continue;
    // Where a lobe is, as a rule.
    const vec3 wi =
        disney_sample(nullptr, c, wo, random.unit_float(), random.unit_float(), random.unit_float()).wi;
    if (wi.z < 1e-3f) continue;
    const BsdfValue value = disney_eval(nullptr, c, wo, wi);
    const Paper paper(m, exact(wi), exact(wo));
    // The half vector is off by 3 roundings, and a lobe falls by at most twice that over its width: the
    // logarithm of 1 / (1 + x^2)^2 has slope 3 at most. The directions' lengths are off by as much as they
    // are rounded.
    const double aspect = std::sqrt(1 - 0.9 * m.anisotropic.value);
    const double coat = m.clearcoat.value > 0 ? 0.1 - 0.099 * m.clearcoat_gloss.value : 1;
    const double width =
        std::min({coat, std::max(1e-3, double(m.roughness.value * m.roughness.value) * aspect)});
    const double tolerance = 3e-6 + 3 * 3 * 0x1p-24 / width;
    const double rounding = 4 * 0x1p-24 * paper.per_cosine;
    const float ours[3] = {value.f_cos.x, value.f_cos.y, value.f_cos.z};
    for (std::size_t i = 0; i < 3; ++i) {
      const double expected = paper.f[i] * double(wi.z);
      ASSERT_NEAR(ours[i], expected, tolerance * expected + rounding * double(wi.z))
          << "set " << k << ", channel " << i;
      lit += expected > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(lit, 40'000);
}

TEST(DisneyBrdf, HasTheDefaultsOfItsAuthors) {
  const DisneyBsdf m;
  EXPECT_EQ(m.specular.value, 0.5f);
  EXPECT_EQ(m.roughness.value, 0.5f);
  EXPECT_EQ(m.sheen_tint.value, 0.5f);
  EXPECT_EQ(m.clearcoat_gloss.value, 1.0f);
}

TEST(Gtr1, IsADistributionOfMicrofacets) {
  // The integral of D cos over the hemisphere is 1, with x = sin^2 as variable pi int D dx; in log x where D
  // is narrow.
  for (const float alpha : {1e-3f, 0.01f, 0.1f, 0.5f, 0.99f, 1.0f}) {
    constexpr int kSteps = 20'000;
    const double low = std::log(1e-12);
    double sum = kPi * 1e-12 * double(gtr1_density(alpha, make_vec3(0, 0, 1)));
    for (int k = 0; k < kSteps; ++k) {
      const double x = std::exp(low * (1 - (k + 0.5) / kSteps));
      const vec3 h = make_vec3(float(std::sqrt(x)), 0, float(std::sqrt(1 - x)));
      sum += kPi * double(gtr1_density(alpha, h)) * x * (-low / kSteps);
    }
    EXPECT_NEAR(sum, 1, 2e-6) << alpha;
  }
  EXPECT_FLOAT_EQ(gtr1_density(1.0f, make_vec3(0, 0, 1)), float(1 / kPi));
}

TEST(Gtr1, SamplesFollowItHoweverNarrow) {
  // log(1 + sin^2 (1 - a^2) / a^2) / -log a^2 is uniform, and the azimuth is.
  constexpr int kSide = 20, kSamples = 200'000;
  RandomNumbers random(32);
  std::vector<double> ps;
  for (const float alpha : {1e-3f, 0.01f, 0.1f, 0.7f}) {
    const double a2 = double(alpha) * double(alpha);
    std::vector<double> counts(kSide * kSide);
    for (int k = 0; k < kSamples; ++k) {
      const vec3 h = gtr1_sample(alpha, random.unit_float(), random.unit_float());
      ASSERT_NEAR(double(length(exact(h))), 1, 1e-6);
      const double sine2 = double(h.x) * h.x + double(h.y) * h.y;
      const double across = std::log1p(sine2 * (1 - a2) / a2) / -std::log(a2);
      double turns = std::atan2(double(h.y), double(h.x)) / (2 * kPi);
      if (turns < 0) turns += 1;
      const auto cell = [](double x) { return std::size_t(std::min(x, 1 - 1e-12) * kSide); };
      ++counts[cell(across) * kSide + cell(turns)];
    }
    ps.push_back(statistics::chi_square_test(
                     counts, std::vector<double>(counts.size(), double(kSamples) / (kSide * kSide)))
                     .p);
  }
  for (const double p : ps) EXPECT_GT(p, statistics::sidak_significance(0.01, ps.size()));
  // The ends of the range.
  for (const float alpha : {1e-3f, 0.1f, 1.0f}) {
    EXPECT_EQ(gtr1_sample(alpha, 0, 0.3f).z, 1);
    const vec3 last = gtr1_sample(alpha, ONE_MINUS_EPSILON, 0.3f);
    EXPECT_TRUE(last.z >= 0 && last.z < 0.01f) << last.z;
  }
}

}  // namespace
}  // namespace penumbra::disney_test
