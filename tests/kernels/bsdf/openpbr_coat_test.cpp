// Coats of OpenPBR's surface with a normal of their own.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/kernels/bsdf/openpbr_surface.h"
#include "tests/kernels/same_value.h"

namespace penumbra::openpbr_test {
namespace {

/// The surface with this normal of its coat, in its own frame.
Surface with_coat_normal(const OpenPbrBsdf& bsdf, const vec3& normal) {
  Surface surface(bsdf);
  surface.closure().variant |= OPENPBR_OWN_COAT;
  surface.closure().coat_normal = normal;
  return surface;
}

/// `w` mirrored about the unit vector `n`.
vec3 mirrored(const vec3& w, const vec3& n) { return sub(scale(n, 2 * dot3(w, n)), w); }

/// A coat of this roughness over what reflects nothing.
OpenPbrBsdf coat_alone(float roughness) {
  OpenPbrBsdf bsdf;
  bsdf.base_color = TexturedColour(glm::vec3(0.0f)), bsdf.specular_weight = 0.0f;
  bsdf.coat_weight = 1.0f, bsdf.coat_roughness = roughness, bsdf.coat_ior = 1.5f;
  return bsdf;
}

TEST(OpenPbrCoat, WithTheNormalOfItsBaseHasTheSameBits) {
  RandomNumbers random(31);
  for (int k = 0; k < 40; ++k) {
    OpenPbrBsdf bsdf = k % 8 == 0 ? random_film(random) : random_surface(random, true);
    bsdf.coat_weight = 0.1f + 0.9f * random.unit_float();
    const Surface own = with_coat_normal(bsdf, kNormal), plain(bsdf);
    for (int j = 0; j < 30; ++j) {
      const vec3 wo = sample_cosine_hemisphere(kNormal, random.unit_float(), random.unit_float());
      vec3 wi = sample_cosine_hemisphere(kNormal, random.unit_float(), random.unit_float());
      if (j % 3 == 0) wi.z = -wi.z;
      const BsdfValue a = own.eval(wo, wi), b = plain.eval(wo, wi);
      EXPECT_TRUE(same(a.f_cos, b.f_cos) && same(a.pdf, b.pdf)) << k;
      const float u = random.unit_float(), v = random.unit_float(), choice = random.unit_float();
      const BsdfSample s = own.sample(wo, u, v, choice), t = plain.sample(wo, u, v, choice);
      EXPECT_TRUE(same(s.wi, t.wi) && same(s.weight, t.weight) && same(s.pdf, t.pdf)) << k;
    }
  }
}

TEST(OpenPbrCoat, OfWhateverNormalReflectsAndTransmitsWhatArrivesAndNoMore) {
  RandomNumbers random(32);
  for (int k = 0; k < 60; ++k) {
    OpenPbrBsdf bsdf = k % 8 == 0 ? random_film(random) : random_surface(random, true);
    bsdf.coat_weight = std::max(number(random), 0.1f);
    const vec3 wo = at_cosine(std::max(0.02f, random.unit_float()), random.between(0, 2 * kPi));
    vec3 normal = at_cosine(random.unit_float(), random.between(0, 2 * kPi));
    if (dot3(normal, wo) < 0.01f) normal = kNormal;
    const Surface surface = with_coat_normal(bsdf, normal);
    const Surface::Energy energy = surface.energy(wo, 1 << 13);
    EXPECT_LE(energy.mean, 1 + 1e-3 + kDeviations * energy.error) << k;
  }
}

TEST(OpenPbrCoat, OverAWhiteOpaqueBaseReflectsAll) {
  RandomNumbers random(33);
  for (int k = 0; k < 40; ++k) {
    OpenPbrBsdf bsdf;
    bsdf.base_color = TexturedColour(glm::vec3(1.0f)), bsdf.base_diffuse_roughness = number(random);
    bsdf.base_metalness = number(random), bsdf.specular_roughness = number(random);
    bsdf.coat_weight = number(random), bsdf.coat_roughness = number(random);
    bsdf.coat_darkening = number(random), bsdf.coat_ior = 1.2f + 0.5f * random.unit_float();
    if (!bsdf.layered()) continue;
    const vec3 wo = at_cosine(0.1 + 0.9 * random.unit_float(), random.between(0, 2 * kPi));
    const vec3 normal = at_cosine(0.3 + 0.7 * random.unit_float(), random.between(0, 2 * kPi));
    if (dot3(normal, wo) < 0.05f) continue;
    const Surface::Energy energy = with_coat_normal(bsdf, normal).energy(wo, 1 << 14);
    EXPECT_NEAR(energy.mean, 1, 5e-3 + kDeviations * energy.error) << k;
  }
}

TEST(OpenPbrCoat, ASmoothOneMirrorsLightAboutItsNormal) {
  for (const double tilt : {0.0, 0.1, 0.4, 0.7, 1.0})
    for (const double azimuth : {0.0, 2.0, 5.0}) {
      const vec3 normal = at_cosine(std::cos(tilt), azimuth);
      const Surface surface = with_coat_normal(coat_alone(0), normal);
      // Seen from above, light comes from twice the tilt; from 0.8 on from below the horizon of the base.
      for (const vec3& wo : {kNormal, at_cosine(0.9, 1)}) {
        const vec3 expected = mirrored(wo, normal);
        const BsdfSample s = surface.sample(wo, 0.3f, 0.6f, 0.5f);
        ASSERT_GT(s.pdf, 0);
        // A microfacet of the least roughness is within some 1e-3 of the normal.
        EXPECT_NEAR(double(dot3(s.wi, expected)), 1, 1e-4) << tilt << ' ' << azimuth;
        if (wo.z == 1.0f) EXPECT_NEAR(double(s.wi.z), std::cos(2 * tilt), 5e-3);
        EXPECT_NEAR(surface.energy(wo, 1 << 10).mean, fresnel(double(dot3(wo, normal)), 1.5), 2e-3)
            << tilt << ' ' << azimuth;
      }
    }
}

TEST(OpenPbrCoat, OverABlackBaseIsTheTurnedCoat) {
  // Whatever its roughness: in a frame about its normal nothing else has a direction.
  RandomNumbers random(34);
  for (int k = 0; k < 60; ++k) {
    OpenPbrBsdf bsdf = coat_alone(0.3f + 0.7f * random.unit_float());
    bsdf.coat_weight = random.unit_float();
    const vec3 normal = at_cosine(0.4 + 0.6 * random.unit_float(), random.between(0, 2 * kPi));
    const Surface turned = with_coat_normal(bsdf, normal), plain(bsdf);
    for (int j = 0; j < 30; ++j) {
      const vec3 wo = sample_cosine_hemisphere(kNormal, random.unit_float(), random.unit_float());
      const vec3 wi = sample_uniform_sphere(random.unit_float(), random.unit_float());
      const vec3 there = to_frame(normal, wo), from = to_frame(normal, wi);
      if (there.z < 0.02f || wo.z < 0.02f || std::abs(from.z) < 1e-3f) continue;
      const double a = double(turned.eval(wo, wi).f_cos.x),
                   b = from.z > 0 ? double(plain.eval(there, from).f_cos.x) : 0.0;
      EXPECT_NEAR(a, b, 1e-4 * (b + 1e-3)) << k;  // roundings of directions
    }
  }
}

TEST(OpenPbrCoat, TheWaysThroughItAreThoseAboutItsNormal) {
  OpenPbrBsdf bsdf;
  bsdf.base_color = TexturedColour(glm::vec3(1.0f)), bsdf.specular_weight = 0.0f;
  bsdf.coat_weight = 1.0f, bsdf.coat_ior = 1.0f, bsdf.coat_color = TexturedColour(glm::vec3(0.25f));
  const vec3 normal = at_cosine(0.8, 0.7);
  const Surface surface = with_coat_normal(bsdf, normal);
  for (const vec3& wo : {at_cosine(1), at_cosine(0.6, 2)})
    for (const vec3& wi : {at_cosine(0.9, 1), at_cosine(0.5, 1.5)}) {
      const double o = double(dot3(wo, normal)), i = double(dot3(wi, normal));
      const double expected = std::pow(0.25, 0.5 * (1 / o + 1 / i)) / kPi * double(wi.z);
      EXPECT_NEAR(double(surface.eval(wo, wi).f_cos.x), expected, 2e-3 * expected);
    }
}

TEST(OpenPbrCoat, OverWhatTransmitsReflectsAboveTheHorizonOfTheBaseOnly) {
  const vec3 normal = at_cosine(std::cos(0.9), 0), below = mirrored(kNormal, normal);
  ASSERT_LT(below.z, 0);
  OpenPbrBsdf coat = coat_alone(0.2f);
  EXPECT_GT(with_coat_normal(coat, normal).eval(kNormal, below).f_cos.x, 0);
  coat.transmission_weight = 1.0f, coat.transmission_color = TexturedColour(glm::vec3(0.0f));
  EXPECT_EQ(with_coat_normal(coat, normal).eval(kNormal, below).f_cos.x, 0);
}

TEST(OpenPbrCoat, SamplesFollowTheDensity) {
  RandomNumbers random(35);
  constexpr int kCases = 12;
  for (int k = 0; k < kCases; ++k) {
    OpenPbrBsdf bsdf = k % 4 == 0 ? random_film(random) : random_surface(random, true);
    bsdf.specular_roughness = 0.4f + 0.6f * random.unit_float();
    bsdf.coat_roughness = 0.4f + 0.6f * random.unit_float();
    bsdf.coat_weight = 0.3f + 0.7f * random.unit_float();
    bsdf.specular_ior = std::max(bsdf.specular_ior, 1.3f), bsdf.specular_weight = 1.0f;
    bsdf.specular_color = TexturedColour(glm::vec3(1.0f));
    const vec3 wo = at_cosine(random.between(0.4, 0.99), random.between(0, 2 * kPi));
    vec3 normal;
    do normal = at_cosine(random.between(0.4, 0.95), random.between(0, 2 * kPi));
    while (dot3(normal, wo) < 0.2f);
    EXPECT_GT(probability_of_samples(with_coat_normal(bsdf, normal), wo, random, k),
              statistics::sidak_significance(0.01, kCases))
        << k;
  }
}

}  // namespace
}  // namespace penumbra::openpbr_test
