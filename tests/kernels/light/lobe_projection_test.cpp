// Triangle lights sampled by the control lobes of glossy closures: the pdf integrates to 1 over the visible
// part of the light, and directions are distributed by it (chi-square); across the horizon, at grazing
// angles, for any roughness and any mixture of the lobes.
#include "kernels/light/lobe_projection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "scenes/device/ltc/ltc_table.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::lobe_projection_test {
namespace {

constexpr int kCells = 8, kFine = 48;  // along each axis of the triangle; of a cell
constexpr int kSamples = 40'000;
constexpr double kSignificance = 0.01;

struct LobeCase {
  std::string name;
  float alpha, cosine;
  float diffuse;       ///< beside a specular reflectance of 1
  float size, height;  ///< of the light, about the mirror direction at distance 1
  float aside = 0;     ///< off it, in its own sizes
  int distribution = DISTRIBUTION_GGX;
};
void PrintTo(const LobeCase& c, std::ostream* out) { *out << c.name; }

const LobeCase kCases[] = {{"Broad", 1.0f, 0.7f, 0, 1, 0},
                           {"Rough", 0.5f, 0.5f, 0, 1, 0},
                           {"RoughAside", 0.5f, 0.5f, 0, 1, 0, 1.5f},
                           {"Medium", 0.2f, 0.6f, 0, 0.5f, 0},
                           {"MediumBeckmann", 0.2f, 0.6f, 0, 0.5f, 0, 0, DISTRIBUTION_BECKMANN},
                           {"Glossy", 0.05f, 0.8f, 0, 0.2f, 0},
                           {"GlossyInALargeLight", 0.05f, 0.8f, 0, 1, 0},
                           {"Shiny", 0.02f, 0.5f, 0, 0.1f, 0},
                           {"NearlyAMirror", 2e-3f, 0.5f, 0, 0.01f, 0},
                           {"AboutTheNormal", 0.1f, 1.0f, 0, 0.3f, 0},
                           {"NextToTheNormal", 0.1f, 0.9999f, 0, 0.3f, 0},
                           {"Grazing", 0.2f, 0.02f, 0, 0.5f, 0},
                           {"GrazingSmooth", 0.02f, 1e-3f, 0, 0.2f, 0},
                           {"BeyondGrazing", 0.3f, 1e-6f, 0, 0.5f, 0},
                           {"AcrossTheHorizon", 0.3f, 0.2f, 0, 0.6f, -0.2f},
                           {"BesideALambert", 0.1f, 0.6f, 0.5f, 0.5f, 0},
                           {"BesideABrightLambert", 0.3f, 0.4f, 5, 1, -0.1f},
                           {"LambertOfALobeElsewhere", 0.02f, 0.9f, 0.2f, 0.5f, 0, 2}};

class LobeProjectionOf : public testing::TestWithParam<LobeCase> {};
INSTANTIATE_TEST_SUITE_P(Cases, LobeProjectionOf, testing::ValuesIn(kCases),
                         [](const auto& tested) { return tested.param.name; });

class Fixture {
 public:
  explicit Fixture(const LobeCase& c, RandomNumbers& random) {
    scene_.ltc_cells = cells_.data();
    scene_.header.tables.ltc_cells.count = int(cells_.size());
    scene_.lights = &light_;
    const Exact3 n = random.direction(), t = normalize(cross(n, random.direction())), b = cross(n, t);
    const long double sine = std::sqrt(1.0L - (long double)c.cosine * c.cosine);
    const Exact3 wo = (long double)c.cosine * n + sine * t, mirror = 2 * dot(n, wo) * n - wo;
    const MicrofacetLobe lobe = microfacet_lobe(&scene_, c.distribution, c.alpha, c.cosine);
    const vec3 kd = make_vec3(c.diffuse, c.diffuse, c.diffuse), ks = make_vec3(1, 1, 1);
    lobes = receiver_lobes(rounded(n), rounded(wo), make_control_lobes(kd, lobe, ks));
    const Exact3 x = normalize(cross(mirror, b)), y = cross(mirror, x);
    const Exact3 middle = mirror + (long double)c.height * n + (long double)(c.aside * c.size) * y;
    const long double s = c.size;
    light_ = {};
    light_.kind = LIGHT_TRIANGLE;
    light_.sampling = EMITTER_PROJECTED;
    light_.p0 = rounded(middle + -0.8L * s * x + -0.6L * s * y);
    light_.p1 = rounded(middle + 0.9L * s * x + -0.3L * s * y);
    light_.p2 = rounded(middle + -0.1L * s * x + s * y);
    if (dot(cross(exact(light_.p1) - exact(light_.p0), exact(light_.p2) - exact(light_.p0)),
            exact(light_.p0)) > 0)
      std::swap(light_.p1, light_.p2);
    projection = project_lobes(light_, make_vec3(0, 0, 0), lobes);
  }

  /// The point of the light with those parameters in [0, 1)^2, uniform in area.
  [[nodiscard]] Exact3 point(double u, double v) const {
    const long double root = std::sqrt((long double)u);
    return exact(light_.p0) + root * (1 - (long double)v) * (exact(light_.p1) - exact(light_.p0)) +
           root * (long double)v * (exact(light_.p2) - exact(light_.p0));
  }
  /// Density of the parameters.
  [[nodiscard]] double density(double u, double v) const {
    const Exact3 p = point(u, v), e1 = exact(light_.p1) - exact(light_.p0),
                 e2 = exact(light_.p2) - exact(light_.p0);
    const long double r = length(p), volume = std::abs(dot(p, cross(e1, e2))) / 2;
    const vec3 wi = rounded(normalize(p));
    FoundLight found{};
    found.wi = wi;
    found.light = 0;
    return double(volume / (r * r * r)) * double(std::max(lobes_density(light_, found, lobes), 0.0f));
  }
  /// Parameters of a direction; false: it misses the light by more than rounding.
  bool parameters(const vec3& wi, double* u, double* v) const {
    const Exact3 d = exact(wi), e1 = exact(light_.p1) - exact(light_.p0),
                 e2 = exact(light_.p2) - exact(light_.p0), n = cross(e1, e2);
    const Exact3 p = (dot(exact(light_.p0), n) / dot(d, n)) * d - exact(light_.p0);
    const long double n2 = dot(n, n), b1 = dot(cross(p, e2), n) / n2, b2 = dot(cross(e1, p), n) / n2;
    const long double sum = std::clamp(b1 + b2, 1e-12L, 1.0L);
    *u = double(sum * sum);
    *v = double(std::clamp(b2 / sum, 0.0L, 1.0L));
    return std::min({b1, b2, 1 - b1 - b2}) > -2e-3L;
  }
  bool sample(float u, float v, vec3* wi, float* pdf) {
    LightReceiver r{};
    r.has_normal = true;
    r.shading = lobes.normal;
    LightSamplings samplings{};
    sample_lobes_light(light_, r, lobes, false, u, v, &samplings, 0);
    *wi = LOAD_LANE_vec3(samplings.wi, 0);
    *pdf = samplings.scale[0] * std::max(dot3(*wi, lobes.normal), 0.0f);
    return samplings.scale[0] > 0;
  }

  ReceiverLobes lobes{};
  LobeProjection projection{};

 private:
  std::vector<LtcCell> cells_ = ltc_table();
  Light light_{};
  Scene scene_{};
};

TEST_P(LobeProjectionOf, SamplesHaveTheirDensity) {
  RandomNumbers random(1);
  Fixture fixture(GetParam(), random);
  ASSERT_GE(fixture.projection.share, 0.0f);
  std::vector<double> expected(kCells * kCells), observed(kCells * kCells);
  double total = 0;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      double sum = 0;
      for (int k = 0; k < kFine; ++k)
        for (int l = 0; l < kFine; ++l)
          sum += fixture.density((i + (k + .5) / kFine) / kCells, (j + (l + .5) / kFine) / kCells);
      total += expected[std::size_t(i * kCells + j)] = sum / (kFine * kFine * kCells * kCells);
    }
  // Of the midpoint rule, on grids of 384^2 points, and of directions in single precision, which are
  // 6e-8 / alpha lobes apart.
  EXPECT_NEAR(total, 1, 2e-3);
  for (double& e : expected) e *= kSamples / total;
  int missed = 0;
  for (int i = 0; i < kSamples; ++i) {
    vec3 wi;
    float pdf;
    ASSERT_TRUE(fixture.sample(random.unit_float(), random.unit_float(), &wi, &pdf));
    ASSERT_TRUE(std::isfinite(pdf) && pdf >= 0) << i;
    ASSERT_NEAR(dot3(wi, wi), 1, 1e-5);
    double u, v;
    missed += fixture.parameters(wi, &u, &v) ? 0 : 1;
    const auto cell = [](double x) { return std::min(int(x * kCells), kCells - 1); };
    observed[std::size_t(cell(u) * kCells + cell(v))] += 1;
  }
  EXPECT_LE(missed, kSamples / 1000);
  const auto result = statistics::chi_square_test(observed, expected);
  EXPECT_GT(result.p, statistics::sidak_significance(kSignificance, std::size(kCases)))
      << "chi2 " << result.statistic << " of " << result.dof;
}

// What a light's sample says of its density is what a direction that finds the light is told.
TEST_P(LobeProjectionOf, FoundDirectionsHaveTheSampledDensity) {
  RandomNumbers random(2);
  Fixture fixture(GetParam(), random);
  for (int i = 0; i < 1000; ++i) {
    vec3 wi;
    float pdf;
    ASSERT_TRUE(fixture.sample(random.unit_float(), random.unit_float(), &wi, &pdf));
    double u, v;
    fixture.parameters(wi, &u, &v);
    const float again = max_f(dot3(wi, fixture.lobes.normal), 0.0f) *
                        lobes_density_over_cosine(fixture.projection, fixture.lobes, wi);
    EXPECT_EQ(pdf, again);
  }
}

}  // namespace
}  // namespace penumbra::lobe_projection_test
