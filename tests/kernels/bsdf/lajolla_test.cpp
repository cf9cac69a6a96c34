// lajolla's Disney BSDF and its lobes against the formulas of the course's handout (UCSD CSE 272, homework 1)
// in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "scenes/bsdfs.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra::lajolla_test {
namespace {

constexpr double kPi = std::numbers::pi;
using Rgb = std::array<double, 3>;

/// The handout's lobes for two directions on the side of the normal, which is z.
struct Handout {
  const DisneySumParameters& p;
  Exact3 in, out, h;
  double h_out;

  Handout(const DisneySumParameters& parameters, const Exact3& wi, const Exact3& wo)
      : p(parameters), in(wi), out(wo), h(normalize(wi + wo)), h_out(double(dot(h, wo))) {}

  static double mix(double a, double b, double t) { return a + t * (b - a); }
  static double fifth(double cosine) { return std::pow(1 - cosine, 5); }
  [[nodiscard]] double base(std::size_t i) const { return double(p.base_color.value[int(i)]); }
  [[nodiscard]] double tint(std::size_t i) const {
    const double luminance = 0.212671 * base(0) + 0.715160 * base(1) + 0.072169 * base(2);
    return luminance > 0 ? base(i) / luminance : 1;
  }
  [[nodiscard]] double diffuse(std::size_t i) const {
    const double rough = p.roughness.value, n_in = double(in.z), n_out = double(out.z);
    const double retro = rough * h_out * h_out;
    const auto factor = [&](double most) {
      return (1 + (most - 1) * fifth(n_in)) * (1 + (most - 1) * fifth(n_out));
    };
    const double plain = factor(0.5 + 2 * retro);
    const double below = 1.25 * (factor(retro) * (1 / (n_in + n_out) - 0.5) + 0.5);
    return base(i) / kPi * mix(plain, below, p.subsurface.value);
  }
  static double shadowing(const Exact3& w, double ax, double ay) {
    const double x = double(w.x) * ax / double(w.z), y = double(w.y) * ay / double(w.z);
    return 1 / (1 + (std::sqrt(1 + x * x + y * y) - 1) / 2);
  }
  [[nodiscard]] double microfacets(double ax, double ay, double density) const {
    return density * shadowing(in, ax, ay) * shadowing(out, ax, ay) / (4 * double(in.z) * double(out.z));
  }
  [[nodiscard]] double metal(std::size_t i) const {
    const double m = p.metallic.value, mirrored = std::pow((p.eta - 1.0) / (p.eta + 1.0), 2);
    const double dielectric = p.specular.value * mirrored * (1 - m) * mix(1, tint(i), p.specular_tint.value);
    const double along = dielectric + m * base(i);
    const double aspect = std::sqrt(1 - 0.9 * p.anisotropic.value), square = std::pow(p.roughness.value, 2);
    const double ax = square / aspect, ay = square * aspect;
    const double x = double(h.x) / ax, y = double(h.y) / ay, t = x * x + y * y + double(h.z * h.z);
    return (along + (1 - along) * fifth(h_out)) * microfacets(ax, ay, 1 / (kPi * ax * ay * t * t));
  }
  [[nodiscard]] double clearcoat() const {
    const double a = (1 - p.clearcoat_gloss.value) * 0.1 + p.clearcoat_gloss.value * 0.001, a2 = a * a;
    const double density = (a2 - 1) / (kPi * std::log(a2) * (1 + (a2 - 1) * double(h.z * h.z)));
    return (0.04 + 0.96 * fifth(h_out)) * microfacets(0.25, 0.25, density);
  }
  [[nodiscard]] double sheen(std::size_t i) const {
    return mix(1, tint(i), p.sheen_tint.value) * fifth(h_out);
  }
  /// The sum without the glass.
  [[nodiscard]] double opaque(std::size_t i) const {
    const double s = p.specular_transmission.value, m = p.metallic.value;
    return (1 - s) * (1 - m) * diffuse(i) + (1 - m) * p.sheen.value * sheen(i) +
           (1 - s * (1 - m)) * metal(i) + 0.25 * p.clearcoat.value * clearcoat();
  }
};

DisneySumParameters random_parameters(RandomNumbers& random) {
  DisneySumParameters p;
  p.base_color = glm::vec3(random.unit_float(), random.unit_float(), random.unit_float());
  for (TexturedNumber* each : {&p.metallic, &p.subsurface, &p.specular, &p.specular_tint, &p.anisotropic,
                               &p.sheen, &p.sheen_tint, &p.clearcoat, &p.clearcoat_gloss})
    *each = random.unit_float();
  p.specular_transmission = float(random.between(0, 0.9));
  p.roughness = float(random.between(0.2, 1));
  p.eta = float(random.between(1.1, 2));
  return p;
}

/// Compares a BSDF with a function of Handout and the channel, for directions where its lobes are. Of narrow
/// lobes the error is that of the half vector, 3 roundings, over the width: see disney_test.cpp. Grazing
/// Fresnel terms have slope 5.
template <typename Lobe, typename Expected>
void compare(std::uint32_t seed, const Lobe& lobe, const Expected& expected) {
  RandomNumbers random(seed);
  int lit = 0;
  for (int k = 0; k < 4'000; ++k) {
    const DisneySumParameters p = random_parameters(random);
    const Closure c = closure_of(material_of(lobe(p)));
    const vec3 wo = sample_cosine_hemisphere(make_vec3(0, 0, 1), random.unit_float(), random.unit_float());
    const vec3 wi =
        disney_sample(nullptr, c, wo, random.unit_float(), random.unit_float(), random.unit_float()).wi;
    if (wo.z < 1e-2f || wi.z < 1e-2f) continue;
    const BsdfValue value = disney_eval(nullptr, c, wo, wi);
    const Handout handout(p, exact(wi), exact(wo));
    const double tolerance = 1e-5 + 9 * 0x1p-24 / (0.1 - 0.099 * p.clearcoat_gloss.value);
    const float ours[3] = {value.f_cos.x, value.f_cos.y, value.f_cos.z};
    for (std::size_t i = 0; i < 3; ++i) {
      const double f_cos = expected(handout, i) * double(wi.z);
      ASSERT_NEAR(ours[i], f_cos, tolerance * f_cos + 2e-6) << "set " << k << ", channel " << i;
      lit += f_cos > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(lit, 6'000);
}

TEST(Lajolla, DiffuseIsThatOfTheHandout) {
  compare(
      41,
      [](const DisneySumParameters& p) {
        return DisneyDiffuseParameters{p.base_color, p.roughness, p.subsurface}.model();
      },
      [](const Handout& handout, std::size_t i) { return handout.diffuse(i); });
}

TEST(Lajolla, MetalIsThatOfTheHandout) {
  compare(
      42,
      [](const DisneySumParameters& p) {
        return DisneyMetalParameters{p.base_color, p.roughness, p.anisotropic}.model();
      },
      [](const Handout& handout, std::size_t i) {
        DisneySumParameters metal = handout.p;
        metal.metallic = TexturedNumber(1.0f);
        Handout whole(metal, handout.in, handout.out);
        return whole.metal(i);
      });
}

TEST(Lajolla, ClearcoatIsThatOfTheHandout) {
  compare(
      43, [](const DisneySumParameters& p) { return DisneyClearcoatParameters{p.clearcoat_gloss}.model(); },
      [](const Handout& handout, std::size_t) { return handout.clearcoat(); });
}

TEST(Lajolla, SheenIsThatOfTheHandout) {
  compare(
      44,
      [](const DisneySumParameters& p) {
        return DisneySheenParameters{p.base_color, p.sheen_tint}.model();
      },
      [](const Handout& handout, std::size_t i) { return handout.sheen(i); });
}

TEST(Lajolla, TheSumIsThatOfTheHandout) {
  compare(
      45, [](const DisneySumParameters& p) { return p.model(); },
      [](const Handout& handout, std::size_t i) {
        return handout.opaque(i) / (1 - double(handout.p.transmission()));
      });
}

}  // namespace
}  // namespace penumbra::lajolla_test
