// OpenPBR's surface with glTF's parameters, by the formulas of its extensions.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "tests/kernels/bsdf/openpbr_surface.h"

namespace penumbra::openpbr_test {
namespace {

TEST(OpenPbrOfGltf, SpecularScalesAllReflectionAndItsColourThatAlongTheNormal) {
  OpenPbrBsdf bsdf;
  bsdf.gltf = bsdf.specular_color_fades = true;
  bsdf.specular_roughness = 0.0f, bsdf.specular_ior = 1.5f;
  for (const double weight : {0.0, 0.4, 1.0})
    for (const double colour : {0.0, 0.5, 1.0, 20.0, 1e3})
      for (const double cosine : {1.0, 0.5, 0.1}) {
        bsdf.specular_weight = float(weight), bsdf.specular_color = TexturedColour(glm::vec3(colour));
        const double f0 = 0.04, grazing = (fresnel(cosine, 1.5) - f0) / (1 - f0);
        const double expected = weight * (grazing + std::min(f0 * colour, 1.0) * (1 - grazing));
        const std::string what = fmt::format("{} {} {}", weight, colour, cosine);
        bsdf.base_color = TexturedColour(glm::vec3(0.0f));
        EXPECT_NEAR(Surface(bsdf).energy(at_cosine(cosine), 1 << 10).mean, expected, 3e-3) << what;
        // What is not reflected is the diffuse base's.
        bsdf.base_color = TexturedColour(glm::vec3(0.6f));
        const double below = 0.6 / kPi * (1 - expected);
        EXPECT_NEAR(double(Surface(bsdf).eval(at_cosine(cosine), at_cosine(0.6, 2)).f_cos.x) / 0.6, below,
                    3e-3 * below + 1e-3)
            << what;
        // Or it is transmitted, with the same refraction, also by rough glass.
        OpenPbrBsdf glass = bsdf;
        glass.transmission_weight = 1.0f;
        for (const float roughness : {0.0f, 0.6f, 1.0f}) {
          glass.specular_roughness = roughness;
          const Surface::Energy energy = Surface(glass).energy(at_cosine(cosine), 1 << 12);
          EXPECT_NEAR(energy.mean, 1, 2e-3 + kDeviations * energy.error) << what << ' ' << roughness;
        }
      }
}

TEST(OpenPbrOfGltf, SpecularChangesNoMetal) {
  OpenPbrBsdf metal;
  metal.gltf = metal.specular_color_fades = true;
  metal.base_metalness = 1.0f, metal.specular_roughness = 0.0f;
  metal.base_color = TexturedColour(glm::vec3(0.7f));
  metal.specular_weight = 0.2f, metal.specular_color = TexturedColour(glm::vec3(0.3f));
  for (const double cosine : {1.0, 1.0 / 7})
    EXPECT_NEAR(Surface(metal).energy(at_cosine(cosine), 1 << 10).mean, 0.7 + 0.3 * std::pow(1 - cosine, 5),
                2e-3);
}

TEST(OpenPbrOfGltf, AnisotropyRaisesTheRoughnessAlongTheTangent) {
  for (const auto& [roughness, strength] : {std::pair(0.4, 0.5), std::pair(0.7, 1.0), std::pair(0.3, 0.2)}) {
    const double across = roughness * roughness, along = across + (1 - across) * strength * strength;
    OpenPbrBsdf plain;
    plain.base_metalness = 1.0f;
    const OpenPbrRoughness both = along_and_across(along, across);
    plain.specular_roughness = both.roughness, plain.specular_anisotropy = both.anisotropy;
    OpenPbrBsdf gltf = plain;
    gltf.gltf = true;
    gltf.specular_roughness = float(roughness), gltf.specular_anisotropy = float(strength);
    const Surface a(gltf), b(plain);
    for (const double azimuth : {0.0, 0.7, kPi / 2}) {
      const vec3 wo = at_cosine(0.8, 0.3), wi = at_cosine(0.6, azimuth);
      const double expected = double(b.eval(wo, wi).f_cos.x);
      EXPECT_NEAR(double(a.eval(wo, wi).f_cos.x), expected, 1e-4 * expected) << roughness << ' ' << azimuth;
    }
    // The distribution as the extension writes it.
    const Microfacets facets = gltf_microfacets(float(roughness), float(strength));
    const vec3 h = at_cosine(0.9, 0.5);
    const double a2 = along * across, x = across * double(h.x), y = along * double(h.y), z = a2 * double(h.z);
    const double w2 = a2 / (x * x + y * y + z * z);
    EXPECT_NEAR(double(microfacet_density(facets, h)), a2 * w2 * w2 / kPi, 1e-4 * a2 * w2 * w2);
  }
}

TEST(OpenPbrOfGltf, SheenHasTheAlbedoOfItsFormulas) {
  // By 3000 x 3000 midpoints of D V, over the cube root of wi's cosine and its azimuth.
  struct Albedo {
    float roughness;
    double cosine, expected;
  };
  const Albedo albedos[] = {{0.3f, 0.1, 0.540856}, {0.3f, 0.6, 0.051749}, {0.5f, 0.1, 0.566615},
                            {0.5f, 0.3, 0.321376}, {0.5f, 1.0, 0.026982}, {1.0f, 0.1, 0.720510},
                            {1.0f, 0.6, 0.306015}, {1.0f, 1.0, 0.163764}};
  for (const Albedo& each : albedos) {
    OpenPbrBsdf bsdf;
    bsdf.base_color = TexturedColour(glm::vec3(0.0f)), bsdf.specular_weight = 0.0f;
    bsdf.gltf = true, bsdf.fuzz_weight = 1.0f, bsdf.fuzz_roughness = each.roughness;
    const Surface::Energy energy = Surface(bsdf).energy(at_cosine(each.cosine), 1 << 14);
    EXPECT_NEAR(energy.mean, each.expected, 2e-3 + kDeviations * energy.error)
        << each.roughness << ' ' << each.cosine;
    EXPECT_NEAR(fuzz_albedo(double(each.roughness), each.cosine), each.expected, 2e-3);
    // What is below has what the brightest channel leaves.
    bsdf.base_color = TexturedColour(glm::vec3(1.0f)), bsdf.fuzz_color = TexturedColour({0.25f, 0.5f, 0.5f});
    const Surface::Energy red = Surface(bsdf).energy(at_cosine(each.cosine), 1 << 14);
    EXPECT_NEAR(red.mean, 1 - 0.25 * each.expected, 3e-3 + kDeviations * red.error)
        << each.roughness << ' ' << each.cosine;
  }
}

TEST(OpenPbrOfGltf, SheetsTransmitDiffuselyWhatTheirBoundaryDoesNotReflect) {
  OpenPbrBsdf sheet;
  sheet.gltf = sheet.thin_walled = true;
  sheet.base_color = TexturedColour(glm::vec3(0.5f)), sheet.specular_roughness = 0.0f;
  sheet.subsurface_weight = 0.4f, sheet.subsurface_anisotropy = 1.0f;
  sheet.subsurface_color = TexturedColour(glm::vec3(0.9f));
  const Surface surface(sheet);
  for (const double cosine : {0.9, 0.3}) {
    const double left = (1 - fresnel(cosine, 1.5)) / kPi;
    const vec3 up = at_cosine(0.6, 2), down = make_vec3(up.x, up.y, -up.z);
    EXPECT_NEAR(double(surface.eval(at_cosine(cosine), down).f_cos.x) / 0.6, 0.4 * 0.9 * left, 1e-3);
    EXPECT_NEAR(double(surface.eval(at_cosine(cosine), up).f_cos.x) / 0.6, 0.6 * 0.5 * left, 1e-3);
  }
}

}  // namespace
}  // namespace penumbra::openpbr_test
