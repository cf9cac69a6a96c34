// OpenPBR's surface with its scene, for tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scenes/bsdfs/facet_albedo.h"
#include "scenes/bsdfs/openpbr.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"
#include "tests/support/statistics.h"

namespace penumbra::openpbr_test {

inline constexpr double kDeviations = 5;  // of the mean of the samples, by its 8 parts

inline constexpr double kPi = std::numbers::pi;
inline const vec3 kNormal = make_vec3(0, 0, 1);

/// A BSDF with its scene.
class Surface {
 public:
  explicit Surface(const OpenPbrBsdf& bsdf) {
    MaterialTables shared(tables_.curves);
    closure_ = closure_of(material_of(bsdf, shared));
    shared.compute();
    scene_ = tables_.scene();
  }
  [[nodiscard]] BsdfValue eval(const vec3& wo, const vec3& wi) const {
    switch (closure_.family) {
      case FAMILY_OPENPBR:
        return openpbr_eval(&scene_, closure_, wo, wi);
      case FAMILY_OPENPBR_LAYERED:
        return openpbr_layered_eval(&scene_, closure_, wo, wi);
      default:
        return openpbr_film_eval(&scene_, closure_, wo, wi);
    }
  }
  [[nodiscard]] BsdfSample sample(const vec3& wo, float u, float v, float choice) const {
    switch (closure_.family) {
      case FAMILY_OPENPBR:
        return openpbr_sample(&scene_, closure_, wo, u, v, choice);
      case FAMILY_OPENPBR_LAYERED:
        return openpbr_layered_sample(&scene_, closure_, wo, u, v, choice);
      default:
        return openpbr_film_sample(&scene_, closure_, wo, u, v, choice);
    }
  }
  [[nodiscard]] const Closure& closure() const { return closure_; }
  [[nodiscard]] Closure& closure() { return closure_; }

  struct Energy {
    double mean, error;  ///< its standard error, by the variance between parts
  };
  /// What leaves of what arrives, in a channel: radiance times the square of the index. The samples are those
  /// of the additive sequence of Roberts 2018 in three dimensions, shifted for each of the parts.
  [[nodiscard]] Energy energy(const vec3& wo, int count, int channel = 0) const {
    constexpr double kRoot = 1.2207440846057596;  // of x^4 = x + 1
    constexpr int kParts = 8;
    double sum = 0, squares = 0;
    for (int part = 0; part < kParts; ++part) {
      double whole = 0;
      const auto number = [&](int i, double step) {
        const double x = 0.5 + (i + 0.618034 * part * count) * step;
        return float(std::min(x - std::floor(x), 1 - 0x1p-24));
      };
      for (int i = 0; i < count / kParts; ++i) {
        const BsdfSample s = sample(wo, number(i, 1 / kRoot), number(i, 1 / (kRoot * kRoot)),
                                    number(i, 1 / (kRoot * kRoot * kRoot)));
        const float weight = channel_of(s.weight, channel);
        if (s.pdf > 0) whole += double(weight) * double(s.eta) * double(s.eta);
      }
      const double mean = whole / (count / kParts);
      sum += mean, squares += mean * mean;
    }
    const double mean = sum / kParts, variance = std::max(0.0, squares / kParts - mean * mean);
    return {mean, std::sqrt(variance / (kParts - 1))};
  }

 private:
  SceneTables tables_;
  Closure closure_{};
  Scene scene_{};
};

inline vec3 at_cosine(double cosine, double azimuth = 0) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return make_vec3(float(sine * std::cos(azimuth)), float(sine * std::sin(azimuth)), float(cosine));
}

/// A number of [0, 1], often one of its ends.
inline float number(RandomNumbers& random) {
  const auto k = random.below(4);
  return k == 0 ? 0.0f : k == 1 ? 1.0f : random.unit_float();
}

inline OpenPbrBsdf random_surface(RandomNumbers& random, bool layered) {
  OpenPbrBsdf bsdf;
  bsdf.base_color = TexturedColour(glm::vec3(random.below(2) == 0 ? 1.0f : number(random)));
  bsdf.base_metalness = number(random);
  bsdf.specular_weight = number(random);
  bsdf.specular_color = TexturedColour(glm::vec3(random.below(2) == 0 ? 1.0f : number(random)));
  bsdf.specular_roughness = number(random);
  bsdf.specular_ior = 1.0f + 2.0f * random.unit_float() * random.unit_float();
  bsdf.gltf = bsdf.specular_color_fades = random.below(3) == 0;
  if (!layered) return bsdf;
  if (random.below(2) == 0) bsdf.base_diffuse_roughness = number(random);
  // Its curves take long.
  if (random.below(40) == 0) bsdf.specular_anisotropy = number(random);
  if (random.below(2) == 0) bsdf.transmission_weight = number(random);
  bsdf.thin_walled = random.below(3) == 0;
  if (random.below(2) == 0) bsdf.coat_weight = number(random);
  bsdf.coat_roughness = number(random), bsdf.coat_darkening = number(random);
  bsdf.coat_ior = 1.0f + random.unit_float();
  if (random.below(3) == 0) bsdf.fuzz_weight = number(random);
  bsdf.fuzz_roughness = number(random);
  return bsdf;
}

inline OpenPbrBsdf random_film(RandomNumbers& random) {
  OpenPbrBsdf bsdf = random_surface(random, true);
  bsdf.specular_anisotropy = TexturedNumber();  // its curves take long
  bsdf.film_weight = std::max(number(random), 0.1f);
  const float thicknesses[] = {0.0f, 1e-3f, 0.1f, 0.3f, 0.6f, 2.0f, 10.0f, 1e3f};
  bsdf.film_thickness = thicknesses[random.below(8)];
  bsdf.film_ior = random.below(4) == 0 ? (random.below(2) == 0 ? 1.0f : 3.0f) : 1.0f + random.unit_float();
  return bsdf;
}

/// Compares samples with the density. Returns the probability of samples as far from it.
inline double probability_of_samples(const Surface& surface, const vec3& wo, RandomNumbers& random,
                                     int which) {
  constexpr int kRows = 8, kColumns = 12, kSamples = 60'000, kParts = 24;
  std::vector<double> expected(2 * kRows * kColumns), observed(expected.size());
  double density = 0;
  for (int i = 0; i < 2 * kRows * kParts; ++i)
    for (int j = 0; j < kColumns * kParts; ++j) {
      const double z = 1 - (i + 0.5) / (kRows * kParts), angle = 2 * kPi * (j + 0.5) / (kColumns * kParts);
      const double r = std::sqrt(1 - z * z), area = 2 * kPi / (double(kRows) * kParts * kColumns * kParts);
      const double share =
          area *
          double(surface.eval(wo, make_vec3(float(r * std::cos(angle)), float(r * std::sin(angle)), float(z)))
                     .pdf);
      expected[std::size_t(i / kParts * kColumns + j / kParts)] += share * kSamples;
      density += share;
    }
  EXPECT_LE(density, 1 + 5e-3) << which;  // of the midpoint rule at these roughnesses
  for (int i = 0; i < kSamples; ++i) {
    const BsdfSample s = surface.sample(wo, random.unit_float(), random.unit_float(), random.unit_float());
    if (!(s.pdf > 0)) continue;
    double angle = std::atan2(double(s.wi.y), double(s.wi.x)) / (2 * kPi);
    angle -= std::floor(angle);
    const int row = std::clamp(int((1 - double(s.wi.z)) * kRows), 0, 2 * kRows - 1);
    ++observed[std::size_t(row * kColumns + std::min(kColumns - 1, int(angle * kColumns)))];
    const BsdfValue value = surface.eval(wo, s.wi);
    EXPECT_NEAR(double(value.pdf), double(s.pdf), 1e-2 * double(s.pdf));
  }
  for (double& e : expected) e = std::max(e, 1e-3);
  return statistics::chi_square_test(observed, expected, 5).p;
}

/// Fresnel's equations as in any textbook.
inline double fresnel(double cosine, double ior) {
  const double t = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
  const double s = (cosine - ior * t) / (cosine + ior * t), p = (ior * cosine - t) / (ior * cosine + t);
  return 0.5 * (s * s + p * p);
}

}  // namespace penumbra::openpbr_test
