// OpenPBR's surface: its energy, its samples, its reciprocity, and its limits against closed forms.
#include "scenes/bsdfs/openpbr.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <string>
#include <utility>

#include "scenes/bsdfs/metalrough.h"
#include "scenes/bsdfs/plastic.h"
#include "tests/kernels/bsdf/openpbr_surface.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::openpbr_test {
namespace {

bool absorbs_nothing(const OpenPbrBsdf& bsdf) {
  const bool white_metal = bsdf.base_metalness.value == 0.0f || bsdf.specular_weight.value == 1.0f;
  // Of glTF's, the brightest channel of a film takes from all.
  if (bsdf.gltf && bsdf.filmed()) return false;
  const bool keeps = bsdf.gltf || (bsdf.specular_color.value.x == 1.0f && white_metal);
  const bool white = !bsdf.scatters_below() || bsdf.subsurface_color.value.x == 1.0f;
  return bsdf.base_color.value.x == 1.0f && keeps && white && !bsdf.inside;
}

// Tables are interpolated, and their quadrature is off by as much.
constexpr double kMostGain = 1e-3, kMostLoss = 5e-3;

void expect_energy(const OpenPbrBsdf& bsdf, const Surface& surface, const vec3& wo, int which,
                   int channel = 0) {
  constexpr int kFew = 1 << 8, kMany = 1 << 15;
  const auto off = [&](const Surface::Energy& e) {
    return e.mean > 1 + kMostGain || (absorbs_nothing(bsdf) && e.mean < 1 - kMostLoss);
  };
  // Few samples say for most that all is well; those that they leave in doubt get many.
  Surface::Energy energy = surface.energy(wo, kFew, channel);
  if (off(energy)) energy = surface.energy(wo, kMany, channel);
  const double allowed = kDeviations * energy.error;
  const std::string what =
      std::to_string(which) + " at cosine " + std::to_string(wo.z) + ", channel " + std::to_string(channel);
  EXPECT_LE(energy.mean, 1 + kMostGain + allowed) << what;
  if (absorbs_nothing(bsdf)) {
    EXPECT_GE(energy.mean, 1 - kMostLoss - allowed) << what;
  }
}

TEST(OpenPbr, ReflectsAndTransmitsWhatArrivesAndNoMore) {
  RandomNumbers random(5);
  for (int k = 0; k < 150; ++k) {
    OpenPbrBsdf bsdf = random_surface(random, k % 4 != 0);
    if (bsdf.transmits() && random.below(3) == 0) bsdf = *bsdf.other_side();
    const Surface surface(bsdf);
    for (int j = 0; j < 3; ++j)
      expect_energy(bsdf, surface,
                    at_cosine(std::max(0.02f, random.unit_float()), random.between(0, 2 * kPi)), k);
  }
}

TEST(OpenPbr, KeepsTheLawAtFiveThousandPoints) {
  RandomNumbers random(21);
  for (int k = 0; k < 5000; ++k) {
    OpenPbrBsdf bsdf = k % 8 == 0 ? random_film(random) : random_surface(random, k % 4 != 1);
    if (random.below(4) == 0) {
      bsdf.subsurface_weight = number(random), bsdf.thin_walled = true;
      bsdf.subsurface_anisotropy = 2 * number(random) - 1;
      bsdf.subsurface_color = TexturedColour(glm::vec3(number(random)));
    }
    if (bsdf.transmits() && random.below(3) == 0) bsdf = *bsdf.other_side();
    const Surface surface(bsdf);
    expect_energy(bsdf, surface, at_cosine(std::max(0.02f, random.unit_float()), random.between(0, 2 * kPi)),
                  k, k % 3);
    if (testing::Test::HasFailure()) return;
  }
}

/// Sets a parameter to an end of its range.
using SetEnd = void (*)(OpenPbrBsdf&, float end);
constexpr SetEnd kEnds[] = {
    [](OpenPbrBsdf& b, float end) { b.base_color = TexturedColour(glm::vec3(end)); },
    [](OpenPbrBsdf& b, float end) { b.base_metalness = end; },
    [](OpenPbrBsdf& b, float end) { b.base_diffuse_roughness = end; },
    [](OpenPbrBsdf& b, float end) { b.specular_weight = end; },
    [](OpenPbrBsdf& b, float end) { b.specular_color = TexturedColour(glm::vec3(end)); },
    [](OpenPbrBsdf& b, float end) { b.specular_roughness = end; },
    [](OpenPbrBsdf& b, float end) { b.specular_ior = 1 + 2 * end; },
    [](OpenPbrBsdf& b, float end) { b.transmission_weight = end; },
    [](OpenPbrBsdf& b, float end) { b.thin_walled = end > 0; },
    [](OpenPbrBsdf& b, float end) { b.coat_weight = end; },
    [](OpenPbrBsdf& b, float end) { b.coat_roughness = end; },
    [](OpenPbrBsdf& b, float end) { b.coat_ior = 1 + end; },
    [](OpenPbrBsdf& b, float end) { b.coat_darkening = end; },
    [](OpenPbrBsdf& b, float end) { b.fuzz_weight = end; },
    [](OpenPbrBsdf& b, float end) { b.fuzz_roughness = end; },
};

// Each four of a white surface without layers, and of one that has half of everything.
TEST(OpenPbr, KeepsTheLawInTheEightCornersOfEveryPairOfParameters) {
  int which = 0;
  for (std::size_t a = 0; a < std::size(kEnds); ++a)
    for (std::size_t b = 0; b < a; ++b)
      for (int corner = 0; corner < 8; ++corner, ++which) {
        OpenPbrBsdf bsdf;
        bsdf.base_color = TexturedColour(glm::vec3(1.0f));
        if (corner >= 4) {
          bsdf.base_metalness = bsdf.specular_roughness = bsdf.transmission_weight = 0.5f;
          bsdf.coat_weight = bsdf.coat_roughness = bsdf.fuzz_weight = bsdf.fuzz_roughness = 0.5f;
        }
        kEnds[a](bsdf, float(corner & 1)), kEnds[b](bsdf, float(corner >> 1 & 1));
        const Surface surface(bsdf);
        for (const double cosine : {0.9, 0.1}) expect_energy(bsdf, surface, at_cosine(cosine), which);
      }
}

TEST(OpenPbr, ClearRoughGlassScattersAllFromBothSides) {
  for (const float roughness : {0.0f, 0.2f, 0.5f, 0.8f, 1.0f})
    for (const float ior : {1.01f, 1.5f, 2.4f})
      for (const double cosine : {1.0, 0.6, 0.2, 0.05}) {
        OpenPbrBsdf glass;
        glass.transmission_weight = 1.0f;
        glass.specular_roughness = roughness, glass.specular_ior = ior;
        for (const OpenPbrBsdf& side : {glass, *glass.other_side()}) {
          const Surface::Energy energy = Surface(side).energy(at_cosine(cosine), 1 << 13);
          EXPECT_NEAR(energy.mean, 1, kMostLoss + kDeviations * energy.error)
              << roughness << ' ' << ior << ' ' << cosine << ' ' << side.inside;
        }
      }
}

// Those that are reciprocal: metals, also anisotropic and with a film; rough diffuse reflection below
// nothing; sheets that scatter light diffusely, to either side; a coat over what reflects nothing, also about
// a normal of its own; and glTF's sheen over the same, where it reflects no more than arrives. Others are
// not: what is below has the share that the layers above leave for wo.
enum class Reciprocal { kMetal, kFilmedMetal, kDiffuse, kSheet, kCoat, kSheen };
OpenPbrBsdf random_reciprocal(RandomNumbers& random, Reciprocal kind) {
  OpenPbrBsdf bsdf = random_surface(random, false);
  bsdf.specular_roughness = 0.2f + 0.8f * random.unit_float();
  bsdf.base_metalness = 0.0f;
  if (kind == Reciprocal::kMetal || kind == Reciprocal::kFilmedMetal) {
    bsdf.base_metalness = 1.0f;
    if (kind == Reciprocal::kFilmedMetal) {
      bsdf.film_weight = random.unit_float(), bsdf.film_thickness = random.unit_float();
      bsdf.film_ior = 1.0f + random.unit_float();
    } else if (random.below(8) == 0) {
      bsdf.specular_anisotropy = 0.5f * random.unit_float();
      bsdf.specular_roughness = 0.5f + 0.5f * random.unit_float();
    }
    return bsdf;
  }
  bsdf.specular_weight = 0.0f;
  if (kind == Reciprocal::kDiffuse || kind == Reciprocal::kSheet)
    bsdf.base_diffuse_roughness = 0.01f + 0.99f * random.unit_float();
  if (kind == Reciprocal::kSheet) {
    bsdf.thin_walled = true;
    bsdf.subsurface_weight = number(random), bsdf.subsurface_anisotropy = 2 * number(random) - 1;
    bsdf.subsurface_color = TexturedColour(glm::vec3(number(random)));
  }
  if (kind != Reciprocal::kCoat && kind != Reciprocal::kSheen) return bsdf;
  bsdf.base_color = TexturedColour(glm::vec3(0.0f));
  if (kind == Reciprocal::kCoat) {
    bsdf.coat_weight = number(random), bsdf.coat_roughness = 0.3f + 0.7f * random.unit_float();
    bsdf.coat_ior = 1.0f + random.unit_float(), bsdf.coat_darkening = number(random);
  } else {
    bsdf.gltf = bsdf.specular_color_fades = true;
    bsdf.fuzz_weight = number(random), bsdf.fuzz_roughness = 0.4f + 0.6f * random.unit_float();
  }
  return bsdf;
}

TEST(OpenPbr, IsReciprocalWithoutLayersOverWhatReflects) {
  RandomNumbers random(6);
  for (int k = 0; k < 96; ++k) {
    const auto kind = Reciprocal(k % 6);
    const OpenPbrBsdf bsdf = random_reciprocal(random, kind);
    Surface surface(bsdf);
    vec3 coat = kNormal;  // whose cosines are the coat's
    if (kind == Reciprocal::kCoat && k % 4 == 0) {
      coat = at_cosine(0.5 + 0.5 * random.unit_float(), random.between(0, 2 * kPi));
      surface.closure().variant |= OPENPBR_OWN_COAT, surface.closure().coat_normal = coat;
    }
    double most = 0;
    for (int j = 0; j < 50; ++j) {
      const vec3 wo = sample_cosine_hemisphere(coat, random.unit_float(), random.unit_float());
      vec3 wi = sample_cosine_hemisphere(coat, random.unit_float(), random.unit_float());
      if (dot3(coat, wo) < 0.02f || dot3(coat, wi) < 0.02f || wo.z < 0.02f || wi.z < 0.02f) continue;
      // Through a sheet the other side looks back, on which all is the same.
      const bool through = kind == Reciprocal::kSheet && j % 2 == 0;
      const auto turned = [&](const vec3& w) { return through ? make_vec3(w.x, w.y, -w.z) : w; };
      const vec3 onwards = turned(wi), seen = through ? wi : onwards, back = turned(wo);
      const double a = double(surface.eval(wo, onwards).f_cos.x) / std::abs(double(dot3(coat, onwards))),
                   b = double(surface.eval(seen, back).f_cos.x) / std::abs(double(dot3(coat, back)));
      // Roundings of directions, which lobes magnify by 1 / alpha; azimuths between the rows of tables.
      const double rounded = bsdf.anisotropic() ? 4e-3 : 2e-4;
      EXPECT_NEAR(a, b, rounded * (a + 1e-3)) << k << ' ' << int(kind);
      most = std::max(most, a);
    }
    const bool black = bsdf.coat_weight.value == 0.0f && bsdf.fuzz_weight.value == 0.0f;
    EXPECT_TRUE(most > 0 || black) << k;
  }
}

TEST(OpenPbr, SamplesFollowTheDensity) {
  RandomNumbers random(8);
  for (int k = 0; k < 16; ++k) {
    OpenPbrBsdf bsdf = random_surface(random, k % 4 != 0);
    bsdf.specular_roughness = 0.4f + 0.6f * random.unit_float();
    bsdf.coat_roughness = 0.4f + 0.6f * random.unit_float();
    bsdf.specular_ior = std::max(bsdf.specular_ior, 1.3f), bsdf.specular_weight = 1.0f;
    if (k == 5) bsdf.specular_anisotropy = 0.6f;
    const Surface surface(bsdf);
    const vec3 wo = at_cosine(random.between(0.2, 0.99), random.between(0, 2 * kPi));
    EXPECT_GT(probability_of_samples(surface, wo, random, k), statistics::sidak_significance(0.01, 16)) << k;
  }
}

TEST(OpenPbr, SmoothDielectricsHaveTheClosedFormOfTheStandard) {
  // Away from the mirror direction a smooth one has 1 - F(wo) of the base.
  OpenPbrBsdf bsdf;
  bsdf.base_color = TexturedColour(glm::vec3(0.6f));
  bsdf.specular_roughness = 0.0f;
  const Surface surface(bsdf);
  for (const double o : {0.9, 0.5, 0.1})
    for (const double i : {0.8, 0.3, 0.05}) {
      const double expected = 0.6 / kPi * (1 - fresnel(o, 1.5));
      EXPECT_NEAR(double(surface.eval(at_cosine(o), at_cosine(i, 2)).f_cos.x) / i, expected,
                  2e-3 * expected + 1e-4);
    }
  // And the mirror has F.
  bsdf.base_color = TexturedColour(glm::vec3(0.0f));
  for (const double o : {1.0, 0.5, 0.1})
    EXPECT_NEAR(Surface(bsdf).energy(at_cosine(o), 1 << 10).mean, fresnel(o, 1.5), 2e-3);
}

TEST(OpenPbr, FuzzHasTheAlbedoOfCycles) {
  // Of Cycles 5.0.1's Sheen BSDF in a white world; its table has other random numbers. Below a roughness of
  // 0.4 it reflects more than the simulation, 4 % at 0.3, for a reason that we do not know.
  struct Albedo {
    float roughness;
    double cosine, expected;
  };
  const Albedo albedos[] = {{0.5f, 0.1, 0.5521}, {0.5f, 0.3, 0.3144},  {0.5f, 0.6, 0.1043},
                            {0.7f, 0.3, 0.4522}, {0.7f, 0.95, 0.1177}, {1.0f, 0.1, 0.6979},
                            {1.0f, 0.6, 0.4589}, {1.0f, 0.95, 0.3532}};
  for (const Albedo& each : albedos) {
    OpenPbrBsdf bsdf;
    bsdf.base_color = TexturedColour(glm::vec3(0.0f)), bsdf.specular_weight = 0.0f;
    bsdf.fuzz_weight = 1.0f, bsdf.fuzz_roughness = each.roughness;
    const Surface::Energy energy = Surface(bsdf).energy(at_cosine(each.cosine), 1 << 10);
    EXPECT_NEAR(energy.mean, each.expected, 4e-3 + kDeviations * energy.error)
        << each.roughness << ' ' << each.cosine;
  }
}

TEST(OpenPbr, FuzzHasTheLobeOfCycles) {
  // Of the same under a sun of irradiance 1 across its rays, at a polar angle and an azimuth from the
  // viewer's.
  struct Radiance {
    float roughness;
    double cosine, polar, azimuth, expected;
  };
  const Radiance radiances[] = {{0.3f, 0.1, 1.2, 0.3, 0.07103}, {0.3f, 0.3, 1, 0, 0.01154},
                                {0.5f, 0.1, 1.3, 3, 0.12917},   {0.5f, 0.3, 0.9, 0, 0.05166},
                                {0.5f, 0.6, 1.1, 1.5, 0.02311}, {0.7f, 0.3, 0.5, 0, 0.07143},
                                {0.7f, 0.9, 1.2, 1, 0.02441},   {1.0f, 0.1, 1.2, 3.1, 0.11118},
                                {1.0f, 0.5, 0.8, 0, 0.10916},   {1.0f, 0.5, 0.8, 3.1, 0.10914}};
  for (const Radiance& each : radiances) {
    OpenPbrBsdf bsdf;
    bsdf.base_color = TexturedColour(glm::vec3(0.0f)), bsdf.specular_weight = 0.0f;
    bsdf.fuzz_weight = 1.0f, bsdf.fuzz_roughness = each.roughness;
    const vec3 wi = at_cosine(std::cos(each.polar), each.azimuth);
    // Both fits have noise of their walks.
    EXPECT_NEAR(double(Surface(bsdf).eval(at_cosine(each.cosine), wi).f_cos.x), each.expected,
                0.025 * each.expected)
        << each.roughness << ' ' << each.cosine << ' ' << each.polar;
  }
}

TEST(OpenPbr, SmoothMetalsHaveTheirColoursAtTheNormalAndAtOneSeventh) {
  OpenPbrBsdf metal;
  metal.base_color = TexturedColour(glm::vec3(0.7f)), metal.specular_color = TexturedColour(glm::vec3(0.8f));
  metal.base_metalness = 1.0f, metal.specular_roughness = 0.0f;
  const Surface surface(metal);
  EXPECT_NEAR(surface.energy(at_cosine(1), 1 << 10).mean, 0.7, 1e-3);
  EXPECT_NEAR(surface.energy(at_cosine(1.0 / 7), 1 << 10).mean, 0.8 * (0.7 + 0.3 * std::pow(6.0 / 7, 5)),
              2e-3);
}

TEST(OpenPbr, ASmoothCoatOverLambertReflectsWhatThePlasticDoes) {
  // F + (1 - F) (1 - K) d / (1 - K d), with the reflectance K of the boundary from inside: the albedo of
  // plastic.
  OpenPbrBsdf bsdf;
  bsdf.base_color = TexturedColour(glm::vec3(0.5f));
  bsdf.specular_weight = 0.0f, bsdf.coat_weight = 1.0f, bsdf.coat_ior = 1.5f;
  const Surface surface(bsdf);
  const double inside = 1 - (1 - mean_fresnel(1.5)) / (1.5 * 1.5);
  for (const double cosine : {1.0, 0.6, 0.3, 0.1}) {
    const double f = fresnel(cosine, 1.5), expected = f + (1 - f) * (1 - inside) * 0.5 / (1 - 0.5 * inside);
    const Surface::Energy energy = surface.energy(at_cosine(cosine), 1 << 13);
    EXPECT_NEAR(energy.mean, expected, 3e-3 + kDeviations * energy.error) << cosine;
  }
}

TEST(OpenPbr, ACoatHasItsColourOnTheWayInAndOut) {
  OpenPbrBsdf bsdf;
  bsdf.base_color = TexturedColour(glm::vec3(1.0f));
  bsdf.specular_weight = 0.0f, bsdf.coat_weight = 1.0f, bsdf.coat_ior = 1.0f;
  bsdf.coat_color = TexturedColour(glm::vec3(0.25f));
  const Surface surface(bsdf);
  for (const double o : {1.0, 0.5})
    for (const double i : {1.0, 0.4}) {
      const double expected = std::pow(0.25, 0.5 * (1 / o + 1 / i)) / kPi;
      EXPECT_NEAR(double(surface.eval(at_cosine(o), at_cosine(i, 1)).f_cos.x) / i, expected, 2e-3 * expected);
    }
}

TEST(OpenPbr, CoatsOfAnyIndexAndColourGiveNumbers) {
  OpenPbrBsdf bsdf;
  bsdf.base_color = TexturedColour(glm::vec3(1.0f));
  bsdf.coat_weight = 1.0f;
  for (const float ior : {1.0f, 1.5f, 1e4f, 1e6f})
    for (const float colour : {0.0f, 1.0f, 2.0f})  // a texture may be above 1
      for (const double cosine : {1.0, 0.5, 1e-3, 1e-6}) {
        bsdf.coat_ior = ior, bsdf.coat_color = TexturedColour(glm::vec3(colour));
        const Surface surface(bsdf);
        const vec3 value = surface.eval(at_cosine(cosine), at_cosine(0.5, 1)).f_cos;
        EXPECT_TRUE(std::isfinite(value.x) && value.x >= 0 && value.x <= 1)
            << ior << ' ' << colour << ' ' << cosine;
        const Surface::Energy energy = surface.energy(at_cosine(cosine), 1 << 8);
        EXPECT_TRUE(std::isfinite(energy.mean)) << ior << ' ' << colour << ' ' << cosine;
      }
}

TEST(OpenPbr, NoChannelHasAnIndexOfOne) {
  OpenPbrBsdf bsdf;
  bsdf.transmission_weight = 1.0f, bsdf.specular_ior = 1.0f;
  bsdf.dispersion_scale = 1.0f, bsdf.dispersion_abbe = 2.0f;
  SceneTables tables;
  MaterialTables shared(tables.curves);
  for (const OpenPbrBsdf& side : {bsdf, *bsdf.other_side()}) {
    const vec3 index = material_of(side, shared).channel_ior;
    for (const double each : {double(index.x), double(index.y), double(index.z)})
      EXPECT_GT(std::abs(std::log(each)), std::log(1.001) - 1e-6);
  }
}

TEST(OpenPbr, ThePlainFamilyIsTheLayeredOneWithoutLayers) {
  RandomNumbers random(12);
  for (int k = 0; k < 100; ++k) {
    const OpenPbrBsdf bsdf = random_surface(random, false);
    OpenPbrBsdf nearly = bsdf;
    nearly.fuzz_weight = 1e-30f;
    const Surface plain(bsdf), layered(nearly);
    ASSERT_NE(plain.closure().family, layered.closure().family);
    const vec3 wo = sample_cosine_hemisphere(kNormal, random.unit_float(), random.unit_float());
    const vec3 wi = sample_cosine_hemisphere(kNormal, random.unit_float(), random.unit_float());
    const double a = double(plain.eval(wo, wi).f_cos.x), b = double(layered.eval(wo, wi).f_cos.x);
    EXPECT_NEAR(a, b, 1e-4 * a + 1e-7) << k;
  }
}

// Thin films. Their reflectance itself is that of thin_film_test.

TEST(OpenPbrFilm, ReflectsAndTransmitsWhatArrivesAndNoMore) {
  RandomNumbers random(15);
  for (int k = 0; k < 80; ++k) {
    OpenPbrBsdf bsdf = random_film(random);
    if (bsdf.transmits() && random.below(3) == 0) bsdf = *bsdf.other_side();
    const Surface surface(bsdf);
    for (int j = 0; j < 3; ++j)
      expect_energy(bsdf, surface,
                    at_cosine(std::max(0.02f, random.unit_float()), random.between(0, 2 * kPi)), k, j);
  }
}

TEST(OpenPbrFilm, ClearRoughGlassScattersAllFromBothSides) {
  for (const float roughness : {0.0f, 0.3f, 1.0f})
    for (const float thickness : {0.0f, 0.25f, 0.5f, 20.0f}) {
      OpenPbrBsdf glass;
      glass.transmission_weight = 1.0f, glass.specular_roughness = roughness;
      glass.film_weight = 1.0f, glass.film_thickness = thickness, glass.film_ior = 1.8f;
      for (const OpenPbrBsdf& side : {glass, *glass.other_side()}) {
        const Surface surface(side);
        for (const double cosine : {1.0, 0.6, 0.2, 0.05})
          for (int channel = 0; channel < 3; ++channel) {
            const Surface::Energy energy = surface.energy(at_cosine(cosine), 1 << 12, channel);
            EXPECT_NEAR(energy.mean, 1, kMostLoss + kDeviations * energy.error)
                << roughness << ' ' << thickness << ' ' << cosine << ' ' << side.inside << ' ' << channel;
          }
      }
    }
}

TEST(OpenPbrFilm, SamplesFollowTheDensity) {
  RandomNumbers random(18);
  for (int k = 0; k < 8; ++k) {
    OpenPbrBsdf bsdf = random_film(random);
    bsdf.specular_roughness = 0.4f + 0.6f * random.unit_float();
    bsdf.coat_roughness = 0.4f + 0.6f * random.unit_float();
    bsdf.specular_ior = std::max(bsdf.specular_ior, 1.3f), bsdf.specular_weight = 1.0f;
    bsdf.specular_color = TexturedColour(glm::vec3(1.0f));
    if (bsdf.transmits() && k % 2 == 0) bsdf = *bsdf.other_side();
    const Surface surface(bsdf);
    const vec3 wo = at_cosine(random.between(0.2, 0.99), random.between(0, 2 * kPi));
    EXPECT_GT(probability_of_samples(surface, wo, random, k), statistics::sidak_significance(0.01, 8)) << k;
  }
}

TEST(OpenPbrFilm, ASmoothOneHasTheColoursOfItsFilm) {
  OpenPbrBsdf bsdf;
  bsdf.base_color = TexturedColour(glm::vec3(0.0f)), bsdf.specular_roughness = 0.0f;
  bsdf.film_weight = 1.0f, bsdf.film_ior = 1.33f;
  for (const float thickness : {0.1f, 0.35f, 0.8f}) {
    bsdf.film_thickness = thickness;
    const Surface surface(bsdf);
    for (const double cosine : {1.0, 0.7, 0.3, 0.1}) {
      const glm::dvec3 expected = film_colour({1.33, 1.33, 1.5, 1e3 * double(thickness)}, cosine);
      // Cosines of microfacets of the least roughness, and the table's interpolation.
      for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(surface.energy(at_cosine(cosine), 1 << 10, channel).mean, expected[channel], 2e-3)
            << thickness << ' ' << cosine << ' ' << channel;
    }
  }
}

TEST(OpenPbrFilm, OfNoThicknessOrNoContrastChangesNothing) {
  RandomNumbers random(19);
  for (int k = 0; k < 40; ++k) {
    OpenPbrBsdf bsdf = random_surface(random, true), film = bsdf;
    film.film_weight = 1.0f;
    const bool thick = k % 2 != 0;
    film.film_thickness = thick ? 0.4f : 0.0f;
    const double coat = double(std::lerp(1.0f, bsdf.coat_ior, bsdf.coat_over_base()));
    if (thick) film.film_ior = bsdf.effective_ior() * float(coat);
    if (thick) film.base_metalness = bsdf.base_metalness = 0.0f;
    const Surface with(film), without(bsdf);
    for (int j = 0; j < 20; ++j) {
      const vec3 wo = sample_cosine_hemisphere(kNormal, random.unit_float(), random.unit_float());
      vec3 wi = sample_cosine_hemisphere(kNormal, random.unit_float(), random.unit_float());
      if (bsdf.transmits() && j % 3 == 0) wi.z = -wi.z;
      const double a = double(with.eval(wo, wi).f_cos.x), b = double(without.eval(wo, wi).f_cos.x);
      // Of the table's interpolation, and of the steps of packed albedos.
      EXPECT_NEAR(a, b, 5e-3 * b + 1e-3) << k;
    }
  }
}

TEST(OpenPbrFilm, AThicknessBetweenTwoHasTheColoursOfItsOwn) {
  // As a texture makes it.
  OpenPbrBsdf textured;
  textured.film_weight = 1.0f, textured.film_thickness.texture = 0;
  textured.film_least = 0.1f, textured.film_most = 0.4f, textured.specular_roughness = 0.5f;
  textured.base_metalness = 0.5f, textured.base_color = TexturedColour(glm::vec3(0.9f, 0.5f, 0.1f));
  Surface rows(textured);
  for (const float place : {0.0f, 0.3f, 0.77f, 1.0f}) {
    OpenPbrBsdf fixed = textured;
    fixed.film_thickness = TexturedNumber(std::lerp(0.1f, 0.4f, place));
    const Surface own(fixed);
    rows.closure().film_thickness = place;
    for (const double cosine : {0.9, 0.4}) {
      const vec3 wo = at_cosine(cosine), wi = at_cosine(0.6, 2.5);
      const vec3 a = rows.eval(wo, wi).f_cos, b = own.eval(wo, wi).f_cos;
      for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(double(channel_of(a, channel)), double(channel_of(b, channel)),
                    5e-3 * double(channel_of(b, channel)) + 1e-4)
            << place << ' ' << cosine << ' ' << channel;
    }
  }
}

TEST(OpenPbrFilm, OverAWhiteMetalChangesNothingAndOverAnyOtherReflectsNoMoreThanArrives) {
  for (const float colour : {0.0f, 0.3f, 0.8f, 1.0f})
    for (const float thickness : {0.1f, 0.3f, 1.0f}) {
      OpenPbrBsdf metal;
      metal.base_metalness = 1.0f, metal.base_color = TexturedColour(glm::vec3(colour));
      OpenPbrBsdf bare = metal;
      bare.base_diffuse_roughness = 1e-30f;  // of the layered family
      metal.film_weight = 1.0f, metal.film_thickness = thickness;
      const Surface surface(metal), without(bare);
      for (const double cosine : {1.0, 0.5, 0.1})
        for (int channel = 0; channel < 3; ++channel) {
          const Surface::Energy energy = surface.energy(at_cosine(cosine), 1 << 12, channel);
          EXPECT_LE(energy.mean, 1 + kMostGain + kDeviations * energy.error);
          if (colour < 1.0f) continue;
          // The same samples.
          EXPECT_NEAR(energy.mean, without.energy(at_cosine(cosine), 1 << 12, channel).mean, 1e-4);
        }
    }
}

TEST(OpenPbrFilm, GivesNumbersAtItsExtremes) {
  for (const float thickness : {0.0f, 1e-3f, 10.0f, 1e3f})
    for (const float ior : {1.0f, 3.0f})
      for (const float base : {1.0f, 1.5f, 3.0f})
        for (const float metal : {0.0f, 1.0f}) {
          OpenPbrBsdf bsdf;
          bsdf.film_weight = 1.0f, bsdf.film_thickness = thickness, bsdf.film_ior = ior;
          bsdf.specular_ior = base, bsdf.base_metalness = metal;
          const Surface surface(bsdf);
          for (const double o : {1.0, 1e-3, 1e-6})
            for (const double i : {1.0, 1e-3, 1e-6}) {
              const BsdfValue value = surface.eval(at_cosine(o), at_cosine(i, 3));
              for (int channel = 0; channel < 3; ++channel) {
                EXPECT_TRUE(std::isfinite(double(channel_of(value.f_cos, channel))));
                EXPECT_GE(double(channel_of(value.f_cos, channel)), 0);
              }
            }
        }
}

TEST(MetalRough, KeepsItsReflectancesAsAnOpenPbrSurface) {
  MetalRoughParameters gltf;
  gltf.specular = 0.5f, gltf.specular_color = TexturedColour(glm::vec3(2, 0.4f, 1));
  const auto along_normal = [](const OpenPbrBsdf& surface) {
    const double step = double(surface.effective_ior() - 1) / double(surface.effective_ior() + 1);
    return surface.specular_color.value * float(step * step) * surface.specular_weight.value;
  };
  // KHR_materials_specular: min(f0 specularColor, 1) specular.
  for (const float coat : {0.0f, 0.7f, 1.0f}) {
    gltf.clearcoat = coat;
    const glm::vec3 f0 = along_normal(gltf.as_openpbr());
    EXPECT_NEAR(f0.x, 0.04f, 1e-5f);
    EXPECT_NEAR(f0.y, 0.008f, 1e-5f);
    EXPECT_NEAR(f0.z, 0.02f, 1e-5f);
  }
  gltf.roughness = 0.5f, gltf.clearcoat_roughness = 1.0f;
  EXPECT_EQ(gltf.as_openpbr().effective_roughness().value, 0.5f) << "whatever the coat's";
}

}  // namespace
}  // namespace penumbra::openpbr_test
