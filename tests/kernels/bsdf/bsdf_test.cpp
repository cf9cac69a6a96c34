// BSDFs: samples against pdfs, normalisation, reciprocity, energy, and the limits of their ranges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/kernels/bsdf/bsdf_cases.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

vec3 direction(double theta, double phi) {
  return make_vec3(float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
                   float(std::cos(theta)));
}

/// From the normal to grazing.
const vec3 kViewers[] = {direction(0, 0), direction(0.5, 0.3), direction(1.0, 2.0), direction(1.4, 4.0),
                         direction(kPi / 2 - 1e-3, 5.5)};
const vec3 kNormal = make_vec3(0, 0, 1);
vec3 mirrored(const vec3& v) { return make_vec3(-v.x, -v.y, v.z); }

/// A grid of 10 x 20 cells in (theta, phi) over the hemisphere, 20 x 20 over the sphere where the BSDF
/// transmits.
constexpr int kRows = 10, kColumns = 20;

/// Integrals over directions: of the density, of f cos, and of the energy that leaves, which is f cos times
/// the square of the index.
struct Integrals {
  double density = 0, reflectance = 0, energy = 0;
  void add(const Integrals& other) {
    density += other.density;
    reflectance += other.reflectance;
    energy += other.energy;
  }
};

/// By 3 x 3 Gauss points, and again in quarters as long as that makes a difference.
class Quadrature {
 public:
  Quadrature(const Closure& closure, const vec3& wo) : closure_(closure), wo_(wo) {}

  /// Over a cell. A lobe is wider than half its parts.
  [[nodiscard]] Integrals cell(int row, int column) const {
    constexpr int kParts = 6;
    const double d_theta = kPi / 2 / (kRows * kParts), d_phi = 2 * kPi / (kColumns * kParts);
    Integrals sum;
    for (int i = row * kParts; i < (row + 1) * kParts; ++i)
      for (int j = column * kParts; j < (column + 1) * kParts; ++j)
        sum.add(refined(i * d_theta, j * d_phi, d_theta, d_phi, gauss(i * d_theta, j * d_phi, d_theta, d_phi),
                        0));
    return sum;
  }

 private:
  [[nodiscard]] Integrals gauss(double theta, double phi, double d_theta, double d_phi) const {
    static const double kNodes[] = {0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)};
    static const double kWeights[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    Integrals sum;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const double at = theta + kNodes[i] * d_theta;
        const vec3 wi = direction(at, phi + kNodes[j] * d_phi);
        const BsdfValue value = eval_bsdf(nullptr, closure_, kNormal, wo_, wi);
        const double weight = kWeights[i] * kWeights[j] * d_theta * d_phi * std::sin(at);
        const double index = index_ratio(closure_, wi);
        sum.add({value.pdf * weight, value.f_cos.x * weight, value.f_cos.x * index * index * weight});
      }
    return sum;
  }
  [[nodiscard]] Integrals refined(double theta, double phi, double d_theta, double d_phi,
                                  const Integrals& whole, int depth) const {
    const double h = d_theta / 2, w = d_phi / 2;
    const Integrals quarters[] = {gauss(theta, phi, h, w), gauss(theta + h, phi, h, w),
                                  gauss(theta, phi + w, h, w), gauss(theta + h, phi + w, h, w)};
    Integrals sum;
    for (const Integrals& quarter : quarters) sum.add(quarter);
    const double change =
        std::max(std::abs(sum.density - whole.density), std::abs(sum.energy - whole.energy));
    // For a viewer at the horizon transmission begins a little below it, with a step.
    const bool at_horizon = std::min(std::abs(theta - kPi / 2), std::abs(theta + d_theta - kPi / 2)) < 1e-9;
    if ((change < kTolerance && depth > (at_horizon ? 5 : 0)) || depth == kDeepest) return sum;
    Integrals finer;
    for (int k = 0; k < 4; ++k)
      finer.add(refined(theta + (k % 2) * h, phi + (k / 2) * w, h, w, quarters[k], depth + 1));
    return finer;
  }

  static constexpr double kTolerance = 1e-7;  ///< of some 10^4 parts
  static constexpr int kDeepest = 9;
  const Closure& closure_;
  vec3 wo_;
};

struct Grid {
  std::vector<double> density;  ///< of each cell
  Integrals total;
};
Grid integrate(const Closure& closure, const vec3& wo, int rows) {
  const Quadrature quadrature(closure, wo);
  Grid grid;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < kColumns; ++j) {
      const Integrals cell = quadrature.cell(i, j);
      grid.density.push_back(cell.density);
      grid.total.add(cell);
    }
  return grid;
}

// Parts of the quadrature, each off by its tolerance, and rounding of the lobes.
constexpr double kQuadratureError = 5e-4;

/// 1% that any of the viewers of any of the cases fails by chance.
const double kViewerSignificance =
    statistics::sidak_significance(0.01, std::size(kViewers) * std::size(kCases));

class Bsdfs : public testing::TestWithParam<BsdfCase> {
 protected:
  Closure closure_ = GetParam().closure();
  int rows_ = GetParam().has(TRANSMITS) ? 2 * kRows : kRows;

  /// How much f may change between two ways to round directions, each turned by 2^-23 or so.
  [[nodiscard]] double rounding(const vec3& wo, const vec3& wi) const {
    const double least = std::min(std::abs(wo.z), std::abs(wi.z)), turn = 16 * 0x1p-23;
    const double cosines = 8 * 0x1p-24 / least;
    if (!GetParam().has(ANISOTROPIC)) return turn * (1 + GetParam().steepness) + cosines;
    // The normal of the microfacet turns more as the sum of both gets shorter: by that times (1 + n).
    const double n = index_ratio(closure_, wi);
    // A thin sheet mirrors, then lets through.
    const bool thin = closure_.family == FAMILY_PRINCIPLEDTHIN;
    const Exact3 to_light = exact(thin ? make_vec3(wi.x, wi.y, std::abs(wi.z)) : wi);
    const Exact3 sum = exact(wo) + n * to_light, h = normalize(sum);
    const double turned = turn * (1 + n) / double(length(sum));
    // d ln D per radian, by the slopes x and y: of 1 / cos^4, and of exp(-q) or 1 / (1 + q)^2.
    const double x = double(h.x / h.z), y = double(h.y / h.z), stretch = 1 + x * x + y * y;
    const double u = std::max(closure_.alpha_u, 1e-9f), v = std::max(closure_.alpha_v, 1e-9f),
                 q = x * x / (u * u) + y * y / (v * v);
    const double factor = GetParam().is_ggx() ? 4 / (1 + q) : 2;
    const double of_one = factor * std::hypot(x / (u * u), y / (v * v)) * stretch + 4 * std::sqrt(stretch);
    const double steepness = GetParam().steepness > 0 ? GetParam().steepness : of_one;
    double fresnel = 0;
    if (GetParam().has(TRANSMITS)) {
      // The square of the refracted cosine is a difference; transmittance goes with that cosine, reflectance
      // at most 4 times as fast. Seen from either side.
      const auto off = [&](double incident, double ior, bool through) {
        const double square = std::abs((incident * incident - 1) / (ior * ior) + 1);
        const double error = 8 * 0x1p-24 * (1 + 1 / (ior * ior));
        return through ? error / square : 4 * error / std::sqrt(std::max(square, error));
      };
      fresnel = off(double(dot(exact(wo), h)), closure_.ior, wi.z < 0);
      if (wi.z < 0 && !thin) fresnel += off(double(dot(exact(wi), h)), 1 / double(closure_.ior), true);
    }
    return turned * (1 + steepness) + cosines + fresnel;
  }
};
class WideBsdfs : public Bsdfs {};
class LobeBsdfs : public Bsdfs {};
class ReciprocalBsdfs : public Bsdfs {};
const auto kNameOf = [](const auto& tested) { return tested.param.name; };
INSTANTIATE_TEST_SUITE_P(All, Bsdfs, testing::ValuesIn(kCases), kNameOf);
INSTANTIATE_TEST_SUITE_P(All, WideBsdfs, testing::ValuesIn(bsdf_cases_of([](const BsdfCase& c) {
                           return c.fits_a_grid && !c.has(DELTA);
                         })),
                         kNameOf);
INSTANTIATE_TEST_SUITE_P(All, LobeBsdfs,
                         testing::ValuesIn(bsdf_cases_of([](const BsdfCase& c) { return !c.has(DELTA); })),
                         kNameOf);
// The attenuations of hair are those of the viewer's direction.
INSTANTIATE_TEST_SUITE_P(All, ReciprocalBsdfs, testing::ValuesIn(bsdf_cases_of([](const BsdfCase& c) {
                           return !c.has(DELTA) && c.made.family != FAMILY_HAIR;
                         })),
                         kNameOf);

TEST_P(WideBsdfs, SamplesFollowTheDensityAndWeightsAddUpToTheReflectance) {
  const int kSamples = 5000 * rows_ * kColumns;
  const bool is_phong = closure_.family == FAMILY_PHONG || closure_.family == FAMILY_DIFFUSE;
  const bool is_diffuse = is_phong && phong_lobe_share(closure_) == 0;
  const double albedo = GetParam().most_energy;
  RandomNumbers random(7);
  for (const vec3& wo : kViewers) {
    const Grid grid = integrate(closure_, wo, rows_);
    const bool from_above = wo.z > 0.999f;
    // 1 but for what a lobe has below the horizon, at most half of it.
    const bool whole = (from_above && GetParam().all_is_found) || is_diffuse;
    EXPECT_LE(grid.total.density, 1 + kQuadratureError);
    EXPECT_GE(grid.total.density, (whole ? 1 : 0.5) - kQuadratureError);
    // No more than arrives; of Phong's from above, where (n + 2) / (2 pi) int cos^(n+1) = 1, just the
    // material's reflectances.
    EXPECT_LE(grid.total.energy, albedo * (1 + kQuadratureError));
    if (is_diffuse || (is_phong && from_above)) {
      EXPECT_NEAR(grid.total.reflectance, albedo, albedo * kQuadratureError);
    }
    std::vector<double> observed(grid.density.size());
    statistics::Sample weights;
    double lost = 0;
    for (int k = 0; k < kSamples; ++k) {
      const BsdfSample s = sample_bsdf(nullptr, closure_, kNormal, wo, random.unit_float(),
                                       random.unit_float(), random.unit_float());
      weights.add(s.pdf > 0 ? s.weight.x : 0);
      if (!(s.pdf > 0)) {
        ++lost;
        continue;
      }
      const double theta = std::acos(std::clamp(s.wi.z, -1.0f, 1.0f));
      double phi = std::atan2(s.wi.y, s.wi.x);
      if (phi < 0) phi += 2 * kPi;
      const int row = std::min(rows_ - 1, int(theta / (kPi / 2) * kRows));
      const int column = std::min(kColumns - 1, int(phi / (2 * kPi) * kColumns));
      ++observed[std::size_t(row * kColumns + column)];
    }
    EXPECT_GT(statistics::t_test(weights, grid.total.reflectance, kQuadratureError * albedo).p,
              kViewerSignificance)
        << "viewer at cosine " << wo.z << ": " << weights.mean() << " and " << grid.total.reflectance;
    // What falls below the horizon is lost, as much as the density lacks of 1.
    EXPECT_NEAR(lost / kSamples, 1 - grid.total.density, kQuadratureError + 5 * std::sqrt(lost) / kSamples);
    std::vector<double> expected = grid.density;
    // A cell that a lobe's rim only touches may get a sample by rounding.
    for (double& e : expected) e = std::max(e * (kSamples - lost) / grid.total.density, 1e-3);
    const statistics::TestResult result = statistics::chi_square_test(observed, expected, 5);
    EXPECT_GT(result.p, kViewerSignificance)
        << "viewer at cosine " << wo.z << ": chi^2 " << result.statistic << " with " << result.dof;
  }
}

TEST_P(ReciprocalBsdfs, AreReciprocal) {
  // Radiance over the square of the index is what is the same both ways.
  // A thin sheet's facets transmit nothing to where they would mirror it from the other side: not so both
  // ways.
  const bool transmits_one_way = closure_.family == FAMILY_PRINCIPLEDTHIN && closure_.spec_trans > 0;
  const Closure behind = seen_from_behind(closure_);
  RandomNumbers random(9);
  for (int k = 0; k < 20'000; ++k) {
    const vec3 wo = sample_cosine_hemisphere(kNormal, random.unit_float(), random.unit_float());
    if (wo.z < 1e-3f) continue;
    const BsdfSample s = sample_bsdf(nullptr, closure_, kNormal, wo, random.unit_float(), random.unit_float(),
                                     random.unit_float());
    if (!(s.pdf > 0) || std::abs(s.wi.z) < 1e-3f) continue;
    const bool through = s.wi.z < 0;
    if (through && transmits_one_way) continue;
    const double index = index_ratio(closure_, s.wi), tolerance = rounding(wo, s.wi);
    if (tolerance > 0.1) continue;  // nothing is known there
    // From the other side z points the other way.
    const auto turned = [&](const vec3& w) { return through ? make_vec3(w.x, w.y, -w.z) : w; };
    const Closure& other = through ? behind : closure_;
    const double there =
        eval_bsdf(nullptr, closure_, kNormal, wo, s.wi).f_cos.x / std::abs(double(s.wi.z)) * index * index;
    const double back = eval_bsdf(nullptr, other, kNormal, turned(s.wi), turned(wo)).f_cos.x / double(wo.z);
    ASSERT_NEAR(there / back, 1, tolerance) << wo.z << " " << s.wi.z;
  }
}

TEST_P(Bsdfs, ValuesAreNeverNegativeAndZeroWhereNothingIsScattered) {
  RandomNumbers random(10);
  for (int k = 0; k < 50'000; ++k) {
    const vec3 n = rounded(random.direction()), wo = rounded(random.direction()),
               wi = rounded(random.direction());
    const BsdfValue value = eval_bsdf(nullptr, closure_, n, wo, wi);
    const bool scatters = dot3(n, wo) > 0 && (dot3(n, wi) > 0 || GetParam().has(TRANSMITS));
    if (!scatters || GetParam().has(DELTA)) {
      ASSERT_EQ(value.f_cos.x, 0);
      ASSERT_EQ(value.pdf, 0);
    } else {
      ASSERT_GE(value.f_cos.x, 0);
      ASSERT_GE(value.pdf, 0);
    }
  }
}

TEST_P(LobeBsdfs, SampleAgreesWithItsOwnEvaluation) {
  RandomNumbers random(11);
  int compared = 0, sampled = 0;
  for (int k = 0; k < 50'000; ++k) {
    // In the frame of the normal exactly.
    const vec3 wo = sample_cosine_hemisphere(kNormal, random.unit_float(), random.unit_float());
    const float u = random.unit_float(), v = random.unit_float(), choice = random.unit_float();
    const BsdfSample s = sample_bsdf(nullptr, closure_, kNormal, wo, u, v, choice);
    const BsdfValue value = eval_bsdf(nullptr, closure_, kNormal, wo, s.wi);
    ASSERT_NEAR(double(length(exact(s.wi))), 1, 1e-6);
    if (!(s.pdf > 0)) continue;
    ASSERT_EQ(s.eta, float(index_ratio(closure_, s.wi)));
    const double allowed = GetParam().has(ANISOTROPIC) ? rounding(wo, s.wi) : 0;
    ++sampled;
    if (allowed > 0.1) continue;
    ++compared;
    ASSERT_NEAR(s.pdf / value.pdf, 1, allowed) << wo.z << " " << s.wi.z;
    ASSERT_NEAR(s.weight.x * s.pdf, value.f_cos.x, (4e-7 + allowed) * value.f_cos.x);
    // In the world to the rounding of the directions, see AreReciprocal.
    const vec3 n = rounded(random.direction()), viewer = from_frame(n, wo.x, wo.y, wo.z);
    if (is_anisotropic(closure_)) continue;  // whose frame is another one there
    const BsdfSample turned = sample_bsdf(nullptr, closure_, n, viewer, u, v, choice);
    ASSERT_NEAR(double(length(exact(turned.wi))), 1, 1e-6);
    const float cosine = dot3(n, turned.wi);
    if (!(turned.pdf > 0) || std::abs(cosine) < 1e-3f || wo.z < 1e-3f) continue;
    const double tolerance = 2 * rounding(wo, s.wi);
    const BsdfValue again = eval_bsdf(nullptr, closure_, n, viewer, turned.wi);
    ASSERT_NEAR(turned.pdf / again.pdf, 1, tolerance);
    ASSERT_NEAR(turned.weight.x * turned.pdf / again.f_cos.x, 1, tolerance);
  }
  EXPECT_GT(compared, sampled / 2) << "of " << sampled;
}

TEST_P(Bsdfs, WeightsAreBoundedAtAnyAngleAndAnyNumbers) {
  // f cos / pdf is a mean of the lobes' quotients.
  const float bound = float(GetParam().most_weight * 1.00001);
  RandomNumbers random(12);
  for (double cosine : {1.0, 0.1, 1e-3, 1e-6, 1e-7})
    for (float u : {0.0f, 0x1p-24f, 0.3f, 0.99f, ONE_MINUS_EPSILON})
      for (float v : {0.0f, 0.125f, 0.5f, ONE_MINUS_EPSILON})
        for (float choice : {0.0f, 0.3f, 0.7f, ONE_MINUS_EPSILON})
          for (int k = 0; k < 10; ++k) {
            const vec3 wo = direction(std::acos(cosine), random.between(0, 2 * kPi));
            const BsdfSample s = sample_bsdf(nullptr, closure_, kNormal, wo, u, v, choice);
            ASSERT_EQ(std::isfinite(s.pdf), !GetParam().has(DELTA));
            ASSERT_GE(s.pdf, 0);
            for (const float weight : {s.weight.x, s.weight.y, s.weight.z})
              ASSERT_TRUE(weight >= 0 && weight <= bound)
                  << weight << " at " << cosine << " by " << u << " " << v;
            ASSERT_TRUE(std::isfinite(s.wi.x) && std::isfinite(s.wi.y) && std::isfinite(s.wi.z));
            ASSERT_GT(s.eta, 0);
          }
}

TEST(DiffuseBsdf, WeightIsTheReflectanceExactly) {
  const BsdfSample s =
      sample_bsdf(nullptr, phong_case("", 0.5, 0, 0).closure(), kNormal, kViewers[1], 0.3f, 0.7f, 0.5f);
  EXPECT_EQ(s.weight.x, 0.5f);
}

TEST(PhongLobe, SamplesFollowTheDensityHoweverNarrow) {
  // In the lobe's own frame: cos^(n+1) of the angle to the mirror direction and the angle about it are
  // uniform, while the whole lobe is above the horizon.
  constexpr int kSide = 20, kSamples = 400'000;
  RandomNumbers random(15);
  std::vector<double> ps;
  for (double exponent : {100.0, 1e3, 1e4, 1e5})
    for (double theta : {0.0, 0.4, 0.8}) {
      const Closure c = phong_case("", 0, 1, exponent).closure();
      const vec3 wo = direction(theta, 1.0);
      const Exact3 mirror = exact(mirrored(wo));
      const Exact3 s = normalize(cross(mirror, {0.3L, -0.8L, 0.1L})), t = cross(mirror, s);
      std::vector<double> counts(kSide * kSide);
      int lost = 0;
      for (int k = 0; k < kSamples; ++k) {
        const BsdfSample sample =
            sample_bsdf(nullptr, c, kNormal, wo, random.unit_float(), random.unit_float(), 0.5f);
        lost += sample.pdf > 0 ? 0 : 1;
        const Exact3 wi = exact(sample.wi), difference = wi - mirror;
        const double power =
            std::exp((exponent + 1) * std::log1p(-0.5 * double(dot(difference, difference))));
        double turns = double(std::atan2(dot(wi, t), dot(wi, s))) / (2 * kPi);
        if (turns < 0) turns += 1;
        const auto cell = [](double x) { return std::size_t(std::min(x, 1 - 1e-12) * kSide); };
        ++counts[cell(power) * kSide + cell(turns)];
      }
      EXPECT_EQ(lost, 0);
      ps.push_back(statistics::chi_square_test(
                       counts, std::vector<double>(counts.size(), double(kSamples) / (kSide * kSide)))
                       .p);
    }
  for (double p : ps) EXPECT_GT(p, statistics::sidak_significance(0.01, ps.size()));
}

TEST(PhongLobe, DensityInItsOwnFrame) {
  // (n + 1) / (2 pi) cos^n, and f = (n + 2) / (2 pi) cos^n.
  RandomNumbers random(16);
  for (double exponent : {0.0, 1.0, 30.0, 1e3, 1e4}) {
    const Closure c = phong_case("", 0, 1, exponent).closure();
    for (int k = 0; k < 2000; ++k) {
      const vec3 wo = direction(random.between(0, 1.2), random.between(0, 6));
      const BsdfSample s =
          sample_bsdf(nullptr, c, kNormal, wo, random.unit_float(), random.unit_float(), 0.5f);
      if (!(s.pdf > 0)) continue;
      const double lobe = cosine_power(mirrored(wo), s.wi, float(exponent));
      ASSERT_NEAR(s.pdf, (exponent + 1) / (2 * kPi) * lobe, 1e-6 * s.pdf);
      ASSERT_NEAR(eval_bsdf(nullptr, c, kNormal, wo, s.wi).f_cos.x,
                  (exponent + 2) / (2 * kPi) * lobe * s.wi.z, 2e-6 * s.pdf);
    }
  }
}

TEST(CosinePower, AgreesWithExtendedPrecision) {
  RandomNumbers random(13);
  for (double exponent : {0.0, 0.5, 1.0, 2.0, 10.0, 100.0, 1e3, 1e4, 1e5}) {
    double worst = 0;
    for (int k = 0; k < 50'000; ++k) {
      // Angles at which the power is between 1 and e^-60.
      const Exact3 a = random.direction(), side = normalize(cross(a, random.direction()));
      const double widest = exponent > 50 ? std::sqrt(120 / exponent) : 1.5;
      const long double angle = std::min(1.5, widest) * random.uniform();
      const vec3 ra = rounded(a), rb = rounded(std::cos(angle) * a + std::sin(angle) * side);
      const long double cosine = dot(normalize(exact(ra)), normalize(exact(rb)));
      const long double truth = std::pow(cosine, (long double)exponent);
      if (truth < 1e-35L) continue;
      const long double versine = 1 - cosine;
      // The versine is off by 8 roundings of itself: the logarithm by that over the cosine and by its own
      // error; the exponential by its own.
      const long double tolerance =
          exponent * (8 * 0x1p-24L * versine / cosine - 4e-7L * std::log(cosine)) + 4e-7L;
      worst = std::max(worst,
                       double(std::abs(cosine_power(ra, rb, float(exponent)) - truth) / truth / tolerance));
    }
    EXPECT_LT(worst, 1) << "error over its bound, exponent " << exponent;
  }
}

TEST(CosinePower, IsZeroBehindAndOneAhead) {
  const vec3 x = make_vec3(1, 0, 0), y = make_vec3(0, 1, 0);
  for (float exponent : {0.0f, 1.0f, 1e4f, 1e5f}) {
    EXPECT_EQ(cosine_power(x, x, exponent), 1);
    EXPECT_EQ(cosine_power(x, y, exponent), 0);
    EXPECT_EQ(cosine_power(x, negate(x), exponent), 0);
  }
}

TEST(PhongLobe, IsAboutTheMirrorDirectionWhateverTheNormal) {
  RandomNumbers random(14);
  const Closure c = phong_case("", 0, 1, 1e4).closure();
  for (int k = 0; k < 10'000; ++k) {
    const vec3 n = rounded(random.direction()), wo = rounded(random.direction());
    if (dot3(n, wo) < 1e-3f) continue;
    const Exact3 mirror = (2 * dot(exact(n), exact(wo))) * exact(n) - exact(wo);
    const BsdfSample s = sample_bsdf(nullptr, c, n, wo, 0, random.unit_float(), 0);
    ASSERT_LE(double(length(exact(s.wi) - mirror)), 24 * 0x1p-24);
    // At its peak, f cos is (n + 2) / (2 pi) cos.
    const double peak = (1e4 + 2) / (2 * kPi) * double(dot(exact(n), mirror));
    ASSERT_NEAR(eval_bsdf(nullptr, c, n, wo, rounded(mirror)).f_cos.x / peak, 1,
                1e-6 / double(dot3(n, wo)) + 1e-5);
  }
}

TEST(BlackBsdf, ReflectsNothing) {
  Closure c = phong_case("", 0, 0.8, 100).closure();
  c.family = FAMILY_BLACK;
  const BsdfValue value = eval_bsdf(nullptr, c, kNormal, kViewers[1], kViewers[2]);
  EXPECT_EQ(value.f_cos.x, 0);
  EXPECT_EQ(value.pdf, 0);
  EXPECT_EQ(sample_bsdf(nullptr, c, kNormal, kViewers[1], 0.5f, 0.5f, 0.5f).pdf, 0);
}

}  // namespace
}  // namespace penumbra
