// Measured BRDFs: against Mitsuba's values of the same files, the formulas of which the files are made, and
// quadrature.
#include "scenes/bsdfs/measured.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "kernels/bsdf/measured.h"
#include "kernels/host/device_scene.h"
#include "kernels/host/measured_check.h"
#include "scenes/spectrum.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/measured_writer.h"
#include "tests/support/statistics.h"

namespace penumbra::measured_test {
namespace {

constexpr double kPi = std::numbers::pi;

/// A file's BRDF in a scene.
class Surface {
 public:
  explicit Surface(const std::string& file) {
    auto brdf = read_measured_file("test", file);
    EXPECT_TRUE(brdf) << brdf.error().message;
    MaterialTables tables(curves_);
    closure_ = closure_of(
        material_of(MeasuredBsdf{"test", std::make_shared<const MeasuredBrdf>(std::move(*brdf))}, tables));
    scene_.curves = curves_.data();
  }
  explicit Surface(const MeasuredFormula& formula) : Surface(measured_fields(formula).file()) {}
  Surface(const Surface&) = delete;

  [[nodiscard]] BsdfValue eval(const vec3& wo, const vec3& wi) const {
    return measured_eval(&scene_, closure_, wo, wi);
  }
  [[nodiscard]] BsdfSample sample(const vec3& wo, float u, float v) const {
    return measured_sample(&scene_, closure_, wo, u, v, 0.5f);
  }
  [[nodiscard]] const Closure& closure() const { return closure_; }
  [[nodiscard]] const std::vector<float>& table() const { return curves_; }

 private:
  std::vector<float> curves_;
  Closure closure_{};
  Scene scene_{};
};

vec3 to_float(const glm::dvec3& w) { return make_vec3(float(w.x), float(w.y), float(w.z)); }
glm::dvec3 to_double(const vec3& w) { return {double(w.x), double(w.y), double(w.z)}; }
double channel(const vec3& c, std::size_t k) { return double(channel_of(c, int(k))); }

MeasuredFormula quarter_formula() {
  MeasuredFormula formula = anisotropic_formula();
  formula.phi = evenly(-kPi, -kPi / 2, 5);
  return formula;
}

MeasuredFormula spectral_formula() {
  MeasuredFormula formula = isotropic_formula();
  formula.wavelengths = {400, 450, 500, 550, 600, 650, 700};
  formula.f_cos = [](const glm::dvec3& wo, const glm::dvec3& wi, std::size_t k) {
    return (0.2 + 0.1 * double(k)) * ggx_reflection(wo, wi, 0.4, 0.4);
  };
  return formula;
}

/// Reflects all light.
MeasuredFormula white_formula(double alpha_u, double alpha_v) {
  MeasuredFormula formula = alpha_u == alpha_v ? isotropic_formula() : anisotropic_formula();
  formula.density = [=](const glm::dvec3& m) { return ggx_density(m, alpha_u, alpha_v); };
  formula.f_cos = [=](const glm::dvec3& wo, const glm::dvec3& wi, std::size_t) {
    return ggx_reflection(wo, wi, alpha_u, alpha_v);
  };
  return formula;
}

const std::map<std::string, MeasuredFormula> kFormulas{{"isotropic", isotropic_formula()},
                                                       {"anisotropic", anisotropic_formula()},
                                                       {"quarter", quarter_formula()},
                                                       {"strange", strange_formula()},
                                                       {"spectral", spectral_formula()}};

TEST(MeasuredBsdf, HasTheValuesOfMitsuba) {
  std::map<std::string, Surface> surfaces;
  for (const auto& [name, formula] : kFormulas) {
    const std::string file = measured_fields(formula).file();
    surfaces.try_emplace(name, file);
    if (const char* folder = std::getenv("PENUMBRA_MEASURED_FOLDER"))
      std::ofstream(std::string(folder) + "/" + name + ".bsdf", std::ios::binary) << file;
  }
  std::ifstream values(PENUMBRA_SOURCE_DIR "/tests/kernels/bsdf/measured_values.txt");
  int lines = 0;
  for (std::string line; std::getline(values, line); ++lines) {
    std::istringstream words(line);
    std::string name;
    vec3 wo{}, wi{};
    double pdf = 0;
    words >> name >> wo.x >> wo.y >> wo.z >> wi.x >> wi.y >> wi.z >> pdf;
    std::vector<double> f_cos;
    for (double each; words >> each;) f_cos.push_back(each);
    if (const auto& wavelengths = kFormulas.at(name).wavelengths; !wavelengths.empty()) {
      // Mitsuba's spectra go on beyond their ends, too.
      std::vector<SpectrumSample> samples{{300, f_cos.front()}};
      for (std::size_t k = 0; k < f_cos.size(); ++k) samples.push_back({double(wavelengths[k]), f_cos[k]});
      samples.push_back({900, f_cos.back()});
      const glm::vec3 rgb = index_to_rgb(samples);
      f_cos = {double(rgb.x), double(rgb.y), double(rgb.z)};
    }
    ASSERT_EQ(f_cos.size(), 3u) << line;
    // Both are of single precision: sums of 32 numbers, whose differences are in the place within a cell, and
    // angles, some 1e-6 of a cell of 1/32.
    constexpr double kRelative = 5e-4;
    const BsdfValue value = surfaces.at(name).eval(wo, wi);
    EXPECT_NEAR(double(value.pdf), pdf, kRelative * pdf + 1e-5) << line;
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(channel(value.f_cos, k), f_cos[k], kRelative * f_cos[k] + 1e-5) << line;
  }
  EXPECT_EQ(lines, 5 * 6 * 12);
}

/// Over the square of half vectors, by midpoints: wi, and the solid angle of it that each stands for.
template <typename Visit>
void for_half_vectors(const glm::dvec3& wo, int side, const Visit& visit) {
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const double u = (i + 0.5) / side, v = (j + 0.5) / side;
      const glm::dvec3 m = half_vector_at(u, v), wi = 2 * glm::dot(wo, m) * m - wo;
      const double cosine = glm::dot(wo, m);
      if (cosine > 0) visit(wi, half_vector_area(u) * 4 * cosine / (double(side) * side));
    }
}

const glm::dvec3 kViewers[] = {at_angles(0, 0), at_angles(0.4, 0.3), at_angles(0.9, 2.0),
                               at_angles(1.3, -1.0), at_angles(1.5, -2.8)};

TEST(MeasuredBsdf, DensityIsThatOfSamples) {
  constexpr int kRows = 8, kColumns = 16, kSamples = 20'000, kSide = 256;
  RandomNumbers random(3);
  const double significance =
      statistics::sidak_significance(0.01, 2 * std::size(kViewers) * kFormulas.size());
  for (const auto& [name, formula] : kFormulas) {
    const Surface surface(formula);
    for (const glm::dvec3& viewer : kViewers) {
      const vec3 wo = to_float(viewer);
      std::vector<double> expected(kRows * kColumns + 1), observed(expected.size());
      const auto bin = [&](const glm::dvec3& wi) {
        const double turns = std::atan2(wi.y, wi.x) / (2 * kPi);
        const int row = std::min(int(wi.z * kRows), kRows - 1);
        return std::size_t(row * kColumns +
                           std::min(int((turns - std::floor(turns)) * kColumns), kColumns - 1));
      };
      double whole = 0, reflected = 0;
      for_half_vectors(viewer, kSide, [&](const glm::dvec3& wi, double area) {
        if (wi.z <= 0) return;
        const BsdfValue value = surface.eval(wo, to_float(wi));
        expected[bin(wi)] += double(value.pdf) * area * kSamples;
        whole += double(value.pdf) * area;
        // Without facets of its own, a file has colours where its density is 0, too; no sample goes there.
        reflected += value.pdf > 0 ? channel(value.f_cos, 0) * area : 0;
      });
      // Of the midpoint rule: cells of densities end at 1/2 of some of its steps, at most.
      constexpr double kQuadrature = 2e-3;
      EXPECT_LE(whole, 1 + kQuadrature) << name;
      expected.back() = (1 - whole) * kSamples;
      statistics::Sample weights;
      for (int i = 0; i < kSamples; ++i) {
        const BsdfSample s = surface.sample(wo, random.unit_float(), random.unit_float());
        ++observed[s.pdf > 0 ? bin(to_double(s.wi)) : expected.size() - 1];
        weights.add(s.pdf > 0 ? double(s.weight.x) : 0);
        if (!(s.pdf > 0)) continue;
        ASSERT_NEAR(double(length3(s.wi)), 1, 1e-6);
        ASSERT_EQ(surface.eval(wo, s.wi).pdf, s.pdf);
      }
      for (double& e : expected) e = std::max(e, 1e-3);
      EXPECT_GT(statistics::chi_square_test(observed, expected, 5).p, significance)
          << name << " at cosine " << viewer.z << ", of which " << whole << " is above";
      EXPECT_GT(statistics::t_test(weights, reflected, kQuadrature * reflected).p, significance)
          << name << " at cosine " << viewer.z << ": " << weights.mean() << " and " << reflected;
    }
  }
}

TEST(MeasuredBsdf, AllSamplesAreAboveWhereAllFacetsAreSeenFromTheNormal) {
  // Facets up to 45 degrees mirror what comes along the normal to above the horizon.
  MeasuredFormula formula = strange_formula();
  formula.density = [](const glm::dvec3& m) { return m.z > 0.8 ? 1.0 : 0.0; };
  const Surface surface(formula);
  double whole = 0;
  for_half_vectors(kViewers[0], 1024, [&](const glm::dvec3& wi, double area) {
    whole += double(surface.eval(to_float(kViewers[0]), to_float(wi)).pdf) * area;
  });
  EXPECT_NEAR(whole, 1, 1e-3);
}

TEST(MeasuredBsdf, WhiteOnesReflectNoMoreThanArrives) {
  constexpr double kQuadrature = 2e-3;  // of midpoints
  for (const double alpha_v : {0.2, 0.5, 1.0})
    for (const double alpha_u : {alpha_v, 0.7}) {
      const Surface surface(white_formula(alpha_u, alpha_v));
      for (const glm::dvec3& viewer : kViewers) {
        double whole = 0;
        for_half_vectors(viewer, 256, [&](const glm::dvec3& wi, double area) {
          whole += channel(surface.eval(to_float(viewer), to_float(wi)).f_cos, 0) * area;
        });
        EXPECT_LE(whole, 1 + kQuadrature) << alpha_u << ' ' << alpha_v << ' ' << viewer.z;
      }
    }
}

/// The largest difference from the formula at directions of whose wo the file has a slice. Half vectors are
/// in the middle of the lobe: at the pole, places in the square of colours go with the root of its sides, and
/// in the last cell are colours from below the horizon. All grids have steps of 1 / `parts`.
double largest_error(MeasuredFormula formula, int parts) {
  formula.vndf = formula.luminance = formula.facets = parts + 1;
  formula.theta = evenly(0, 0.6, 3), formula.phi = {-2.0};  // which means nothing
  const Surface surface(formula);
  RandomNumbers random(5);
  double most = 0;
  for (int k = 0; k < 3000; ++k) {
    const glm::dvec3 wo = at_angles(formula.theta[random.below(3)], random.between(-kPi, kPi));
    const glm::dvec3 m = half_vector_at(random.between(0.45, 0.7), random.uniform());
    const glm::dvec3 wi = 2 * glm::dot(wo, m) * m - wo;
    if (wi.z < 0.3) continue;
    const double expected = formula.f_cos(wo, wi, 0);
    most = std::max(most, std::abs(channel(surface.eval(to_float(wo), to_float(wi)).f_cos, 0) - expected));
  }
  return most;
}

TEST(MeasuredBsdf, ErrorFallsWithTheSquareOfTheSteps) {
  // Bilinear interpolation is off by h^2 / 8 times second derivatives; halving h leaves a quarter. The
  // largest of finitely many points, and higher orders: a third at most.
  const double coarse = largest_error(isotropic_formula(), 16), fine = largest_error(isotropic_formula(), 32),
               finest = largest_error(isotropic_formula(), 64);
  EXPECT_LT(fine, coarse / 3);
  EXPECT_LT(finest, fine / 3);
  EXPECT_LT(finest, 5e-3);
}

TEST(MeasuredBsdf, IsIsotropicOrHasItsSymmetry) {
  RandomNumbers random(6);
  const Surface isotropic(isotropic_formula()), half(anisotropic_formula()), quarter(quarter_formula());
  EXPECT_EQ(isotropic.closure().anisotropic, 0.0f);
  EXPECT_NE(half.closure().anisotropic, 0.0f);
  double differs = 0;
  for (int k = 0; k < 500; ++k) {
    const glm::dvec3 wo = at_angles(random.between(0.1, 1.4), random.between(-kPi, kPi)),
                     wi = at_angles(random.between(0, 1.4), random.between(-kPi, kPi));
    const auto turned = [](const glm::dvec3& w, double angle) {
      return glm::dvec3(w.x * std::cos(angle) - w.y * std::sin(angle),
                        w.x * std::sin(angle) + w.y * std::cos(angle), w.z);
    };
    const auto value = [&](const Surface& surface, double angle, bool mirrors) {
      glm::dvec3 a = turned(wo, angle), b = turned(wi, angle);
      if (mirrors) a.y = -a.y, b.y = -b.y;
      const BsdfValue found = surface.eval(to_float(a), to_float(b));
      return glm::dvec2(channel(found.f_cos, 1), double(found.pdf));
    };
    const auto expect_same = [](const glm::dvec2& a, const glm::dvec2& b) {
      for (int i = 0; i < 2; ++i) EXPECT_NEAR(a[i], b[i], 1e-3 * a[i] + 1e-5);
    };
    expect_same(value(isotropic, 0, false), value(isotropic, 1.1, false));
    expect_same(value(half, 0, false), value(half, kPi, false));
    expect_same(value(quarter, 0, false), value(quarter, kPi, false));
    expect_same(value(quarter, 0, false), value(quarter, 0, true));
    differs += std::abs(value(half, 0, false)[0] - value(half, kPi / 2, false)[0]);
  }
  EXPECT_GT(differs, 1);
}

TEST(MeasuredBsdf, GivesNumbersAtItsExtremes) {
  MeasuredFormula dark = strange_formula();  // no density at all for some wo
  dark.f_cos = [](const glm::dvec3& wo, const glm::dvec3& wi, std::size_t) {
    return wo.z < 0.8 ? 0.0 : wi.z;
  };
  std::vector<MeasuredFormula> formulas{dark, isotropic_formula(1e-3), isotropic_formula(0.01)};
  for (const auto& [name, formula] : kFormulas) formulas.push_back(formula);
  for (const MeasuredFormula& formula : formulas) {
    const Surface surface(formula);
    const auto expect_numbers = [](const vec3& f, float pdf) {
      for (std::size_t k = 0; k < 3; ++k) ASSERT_TRUE(std::isfinite(channel(f, k)) && channel(f, k) >= 0);
      ASSERT_TRUE(std::isfinite(pdf) && pdf >= 0);
    };
    for (const double cosine : {1.0, 0.5, 1e-3, 1e-6, 1e-20, -0.1})
      for (const double azimuth : {0.0, kPi / 2, kPi, -2.0}) {
        const vec3 wo =
            to_float(at_angles(0, 0) * cosine + std::sqrt(1 - cosine * cosine) * at_angles(kPi / 2, azimuth));
        for (const double other : {1.0, 1e-3, 1e-6, 1e-20, -0.1})
          for (const double turn : {0.0, 1.0, kPi}) {
            const vec3 wi = to_float(glm::dvec3(0, 0, other) +
                                     std::sqrt(1 - other * other) * at_angles(kPi / 2, azimuth + turn));
            const BsdfValue value = surface.eval(wo, wi);
            expect_numbers(value.f_cos, value.pdf);
            if (cosine < 0 || other < 0) {
              EXPECT_EQ(value.pdf, 0.0f);
              EXPECT_EQ(value.f_cos.x, 0.0f);
            }
          }
        for (const float u : {0.0f, 0x1p-24f, 0.5f, ONE_MINUS_EPSILON})
          for (const float v : {0.0f, 0x1p-24f, 0.5f, ONE_MINUS_EPSILON}) {
            const BsdfSample s = surface.sample(wo, u, v);
            expect_numbers(s.weight, s.pdf);
            EXPECT_NEAR(double(length3(s.wi)), 1, 1e-5);
          }
      }
  }
}

TEST(MeasuredTable, HasTheSizeThatItsHeaderSays) {
  for (const auto& [name, formula] : kFormulas) {
    const Surface surface(formula);
    EXPECT_EQ(measured_table_size(surface.table()), std::int64_t(surface.table().size())) << name;
    for (const float bad : {0.0f, -1.0f, 1e9f, std::numeric_limits<float>::quiet_NaN()})
      for (int i = 0; i < 10; ++i) {
        std::vector<float> table = surface.table();
        table[std::size_t(i)] = bad;
        EXPECT_EQ(measured_table_size(table), -1);
      }
  }
}

TEST(MeasuredTable, AlbedoIsThatOfTheKernel) {
  for (const auto& [name, formula] : kFormulas) {
    const auto brdf = read_measured_file("test", measured_fields(formula).file());
    const auto nearest = std::ranges::min_element(
        brdf->theta, {}, [](float theta) { return std::abs(double(theta) - kPi / 4); });
    // Single precision has some numbers below -pi, which are azimuths near the other end.
    const glm::dvec3 wo = at_angles(double(*nearest), double(brdf->phi.front()) + 1e-6);
    const Surface surface(formula);
    glm::dvec3 sum(0);
    for_half_vectors(wo, 512, [&](const glm::dvec3& wi, double area) {
      sum += area * to_double(surface.eval(to_float(wo), to_float(wi)).f_cos);
    });
    const glm::vec3 albedo = measured_albedo(*brdf);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(double(albedo[c]), sum[c], 2e-3 * sum[c]) << name;  // of both rules
  }
}

}  // namespace
}  // namespace penumbra::measured_test
