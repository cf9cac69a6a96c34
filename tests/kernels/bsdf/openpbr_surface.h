// OpenPBR's surface with its scene, for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernels/host/device_scene.h"
#include "scenes/bsdfs/facet_albedo.h"
#include "scenes/bsdfs/openpbr.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/scene_tables.h"

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

/// Fresnel's equations as in any textbook.
inline double fresnel(double cosine, double ior) {
  const double t = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
  const double s = (cosine - ior * t) / (cosine + ior * t), p = (ior * cosine - t) / (ior * cosine + t);
  return 0.5 * (s * s + p * p);
}

}  // namespace penumbra::openpbr_test
