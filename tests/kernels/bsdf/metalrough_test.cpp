// The metallic-roughness BSDF: its energy, its samples, and its lobes against the formulas of glTF 2.0.
#include "scenes/bsdfs/metalrough.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernels/host/device_scene.h"
#include "scenes/bsdfs/reflection_albedo.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra::metalrough_test {
namespace {

constexpr double kPi = std::numbers::pi;

/// A BSDF with its scene.
class Surface {
 public:
  explicit Surface(const MetalRoughBsdf& bsdf) {
    MaterialTables shared(tables_.curves);
    closure_ = closure_of(material_of(bsdf, shared));
    shared.compute();
    scene_ = tables_.scene();
  }
  [[nodiscard]] BsdfValue eval(const vec3& wo, const vec3& wi) const {
    return metalrough_eval(&scene_, closure_, wo, wi);
  }
  [[nodiscard]] BsdfSample sample(const vec3& wo, float u, float v, float choice) const {
    return metalrough_sample(&scene_, closure_, wo, u, v, choice);
  }
  /// The mean weight of `count` samples in red: the directional albedo. They are those of the additive
  /// sequence of Roberts 2018 in three dimensions.
  [[nodiscard]] double albedo(const vec3& wo, int count) const {
    constexpr double kRoot = 1.2207440846057596;  // of x^4 = x + 1
    double sum = 0;
    const auto number = [](int i, double step) {
      const double x = 0.5 + i * step;
      return float(std::min(x - std::floor(x), 1 - 0x1p-24));
    };
    for (int i = 0; i < count; ++i) {
      const BsdfSample s = sample(wo, number(i, 1 / kRoot), number(i, 1 / (kRoot * kRoot)),
                                  number(i, 1 / (kRoot * kRoot * kRoot)));
      if (s.pdf > 0) sum += double(s.weight.x);
    }
    return sum / count;
  }

 private:
  SceneTables tables_;
  Closure closure_{};
  Scene scene_{};
};

vec3 at_cosine(double cosine) { return make_vec3(float(std::sqrt(1 - cosine * cosine)), 0, float(cosine)); }

constexpr double kAlbedoError = 1.5e-3;  // of the interpolated table, and of the samples
const double kCosines[] = {1, 0.9, 0.7, 0.5, 0.342, 0.174, 0.1, 0.05};

TEST(MetalRough, AWhiteSurfaceReflectsAllLight) {
  for (const float metallic : {0.0f, 1.0f})
    for (const float roughness : {0.05f, 0.2f, 0.5f, 0.8f, 1.0f})
      for (const float specular : {0.0f, 1.0f})
        for (const double cosine : kCosines) {
          MetalRoughBsdf bsdf;
          bsdf.metallic = metallic, bsdf.roughness = roughness, bsdf.specular = specular;
          EXPECT_NEAR(Surface(bsdf).albedo(at_cosine(cosine), 1 << 16), 1.0, 2 * kAlbedoError)
              << metallic << ' ' << roughness << ' ' << specular << ' ' << cosine;
        }
}

TEST(MetalRough, NeverReflectsMoreThanArrives) {
  RandomNumbers random(5);
  for (int k = 0; k < 200; ++k) {
    const auto number = [&] { return random.below(3) == 0 ? 1.0f : random.unit_float(); };
    MetalRoughBsdf bsdf;
    bsdf.metallic = number(), bsdf.roughness = number(), bsdf.specular = number();
    bsdf.ior = random.below(4) == 0 ? 0.0f : 1.0f + 2.0f * random.unit_float();
    bsdf.specular_color = TexturedColour(glm::vec3(3.0f * random.unit_float()));
    bsdf.clearcoat = number(), bsdf.clearcoat_roughness = number();
    const float cosine = std::max(0.02f, random.unit_float());
    // What is lost is given back by the table's albedo, whose error that divides.
    const double once =
        microfacet_albedo(std::max(1e-3, std::pow(double(bsdf.roughness.value), 2)), cosine).plain;
    EXPECT_LE(Surface(bsdf).albedo(at_cosine(cosine), 1 << 17), 1 + kAlbedoError * (1 + 1 / once)) << k;
  }
}

TEST(MetalRough, SamplesAreWorthWhatTheIntegralIs) {
  for (const float roughness : {0.4f, 1.0f})
    for (const double cosine : {0.95, 0.4}) {
      MetalRoughBsdf bsdf;
      bsdf.base_color = TexturedColour(glm::vec3(0.6f));
      bsdf.metallic = 0.3f, bsdf.roughness = roughness, bsdf.clearcoat = 1.0f,
      bsdf.clearcoat_roughness = 0.4f;
      const Surface surface(bsdf);
      const vec3 wo = at_cosine(cosine);
      constexpr int kSteps = 600;
      double reflected = 0, density = 0;
      for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
          const double z = (i + 0.5) / kSteps, angle = 2 * kPi * (j + 0.5) / kSteps, r = std::sqrt(1 - z * z);
          const BsdfValue value =
              surface.eval(wo, make_vec3(float(r * std::cos(angle)), float(r * std::sin(angle)), float(z)));
          reflected += 2 * kPi * double(value.f_cos.x) / (double(kSteps) * kSteps);
          density += 2 * kPi * double(value.pdf) / (double(kSteps) * kSteps);
        }
      EXPECT_NEAR(surface.albedo(wo, 1 << 17), reflected, kAlbedoError);
      EXPECT_LE(density, 1 + kAlbedoError);
      EXPECT_GE(density, 0.8) << "the rest are microfacets' reflections into the surface";
    }
}

/// Appendix B.3: V D of the trowbridge-reitz distribution, with the correlation of masking left out, as the
/// appendix has it.
double specular_brdf(double alpha, const Exact3& wo, const Exact3& wi) {
  const Exact3 h = normalize(wo + wi);
  const double a2 = alpha * alpha, n_h = double(h.z), n_l = double(wi.z), n_v = double(wo.z);
  const double d = a2 / (kPi * std::pow(n_h * n_h * (a2 - 1) + 1, 2));
  const auto v = [&](double n) { return 1 / (n + std::sqrt(a2 + (1 - a2) * n * n)); };
  return v(n_l) * v(n_v) * d;
}

TEST(MetalRough, ItsLobesAreThoseOfTheSpecification) {
  RandomNumbers random(9);
  for (int k = 0; k < 2000; ++k) {
    const float roughness = 0.2f + 0.8f * random.unit_float(), f0 = 0.04f;
    const double alpha = double(roughness) * double(roughness);
    const vec3 wo = sample_cosine_hemisphere(make_vec3(0, 0, 1), random.unit_float(), random.unit_float());
    const vec3 wi = sample_cosine_hemisphere(make_vec3(0, 0, 1), random.unit_float(), random.unit_float());
    if (wo.z < 0.05f || wi.z < 0.05f) continue;
    const Exact3 h = normalize(exact(wo) + exact(wi));
    const double schlick = std::pow(1 - double(dot(exact(wo), h)), 5),
                 brdf = specular_brdf(alpha, exact(wo), exact(wi));
    const MicrofacetAlbedo albedo = microfacet_albedo(alpha, double(wo.z));
    const double lost = 1 / albedo.plain - 1;  // and given back
    MetalRoughBsdf metal;
    metal.base_color = TexturedColour(glm::vec3(0.5f));
    metal.metallic = 1.0f, metal.roughness = roughness;
    const double metal_expected = (0.5 + 0.5 * schlick) * (1 + 0.5 * lost) * brdf * double(wi.z);
    EXPECT_NEAR(Surface(metal).eval(wo, wi).f_cos.x, metal_expected, 2e-3 * metal_expected) << k;
    MetalRoughBsdf dielectric;
    dielectric.base_color = TexturedColour(glm::vec3(0.5f));
    dielectric.roughness = roughness;
    const double given = 1 + f0 * lost;
    const double layer = (f0 * (albedo.plain - albedo.schlick) + albedo.schlick) * given;
    const double expected =
        ((f0 + (1 - f0) * schlick) * given * brdf + (1 - layer) * 0.5 / kPi) * double(wi.z);
    EXPECT_NEAR(Surface(dielectric).eval(wo, wi).f_cos.x, expected, 2e-3 * expected) << k;
  }
}

TEST(MicrofacetAlbedos, AreTheIntegralOfTheLobe) {
  for (const double alpha : {0.3, 0.6, 1.0})
    for (const double cosine : {1.0, 0.6, 0.2}) {
      const Exact3 wo{std::sqrt(1 - cosine * cosine), 0, cosine};
      constexpr int kSteps = 1000;
      double plain = 0, schlick = 0;
      for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
          const double z = (i + 0.5) / kSteps, angle = kPi * (j + 0.5) / kSteps, r = std::sqrt(1 - z * z);
          const Exact3 wi{r * std::cos(angle), r * std::sin(angle), z};
          const double value = specular_brdf(alpha, wo, wi) * z * 2 * kPi / (double(kSteps) * kSteps);
          plain += value;
          schlick += value * std::pow(1 - double(dot(wo, normalize(wo + wi))), 5);
        }
      const MicrofacetAlbedo albedo = microfacet_albedo(alpha, cosine);
      EXPECT_NEAR(albedo.plain, plain, 1e-3) << alpha << ' ' << cosine;
      EXPECT_NEAR(albedo.schlick, schlick, 1e-3) << alpha << ' ' << cosine;
    }
}

}  // namespace
}  // namespace penumbra::metalrough_test
