// Plastics against Mitsuba 3.9.1, and the transmittance of their boundaries.
#include <gtest/gtest.h>

#include <cmath>
#include <variant>
#include <vector>

#include "scenes/bsdfs/microfacet_diffuse.h"
#include "scenes/bsdfs/plastic.h"
#include "tests/kernels/bsdf/lobes.h"

namespace penumbra::plastic_test {
namespace {

using lobes::direction;

/// What Mitsuba's scalar_rgb says of a pair of directions, (polar angle, azimuth) each.
struct MitsubaValue {
  double wo[2], wi[2], f_cos[3], pdf;
};
struct MitsubaPlastic {
  std::variant<PlasticBsdf, RoughPlasticBsdf> bsdf;
  std::vector<MitsubaValue> values;
};
const MitsubaPlastic kMitsuba[] = {
    {PlasticBsdf{.diffuse = glm::vec3(0.5f, 0.3f, 0.2f),
                 .specular = glm::vec3(1, 1, 1),
                 .int_ior = 1.49f,
                 .ext_ior = 1.000277f,
                 .nonlinear = false},
     {{{0, 0}, {0.4, 1}, {0.1490158, 0.08940948, 0.05960632}, 0.2616102},
      {{0.4, 1}, {0.41, 4.1616}, {0.1482984, 0.08897907, 0.05931938}, 0.2601399},
      {{1, -2}, {1.01, 1.1616}, {0.0793687, 0.04762122, 0.03174748}, 0.1358457},
      {{1, -2}, {1.45, 0.3}, {0.009545467, 0.00572728, 0.003818187}, 0.03077832},
      {{1.45, 0.3}, {1.46, 3.4616}, {0.004372913, 0.002623748, 0.001749165}, 0.008521524},
      {{1.56, 2.9}, {0.4, 1}, {0.009416952, 0.005650172, 0.003766781}, 0.006187593}}},
    {PlasticBsdf{.diffuse = glm::vec3(0.1f, 0.27f, 0.36f),
                 .specular = glm::vec3(1, 0.5f, 0.25f),
                 .int_ior = 1.9f,
                 .ext_ior = 1,
                 .nonlinear = true},
     {{{0, 0}, {0.4, 1}, {0.00717602, 0.02254418, 0.03290839}, 0.2335192},
      {{0.4, 1}, {0.41, 4.1616}, {0.007140121, 0.0224314, 0.03274377}, 0.2321981},
      {{1, -2}, {1.01, 1.1616}, {0.003774697, 0.01185859, 0.01731032}, 0.1227269},
      {{1, -2}, {1.45, 0.3}, {0.0004594661, 0.001443459, 0.002107058}, 0.02780603},
      {{1.45, 0.3}, {1.46, 3.4616}, {0.0002133757, 0.0006703411, 0.0009785163}, 0.009299599},
      {{1.56, 2.9}, {0.4, 1}, {0.0004700135, 0.001476594, 0.002155427}, 0.007497471}}},
    {PlasticBsdf{.diffuse = glm::vec3(0.5f, 0.3f, 0.2f),
                 .specular = glm::vec3(1, 1, 1),
                 .int_ior = 1,
                 .ext_ior = 1.5f,
                 .nonlinear = false},
     {{{0, 0}, {0.4, 1}, {0.3335129, 0.2001078, 0.1334052}, 0.2606069},
      {{0.4, 1}, {0.41, 4.1616}, {0.3307643, 0.1984586, 0.1323057}, 0.2569779},
      {{1, -2}, {1.01, 1.1616}, {0, 0, 0}, 0},
      {{1, -2}, {1.45, 0.3}, {0, 0, 0}, 0},
      {{1.45, 0.3}, {1.46, 3.4616}, {0, 0, 0}, 0},
      {{1.56, 2.9}, {0.4, 1}, {0, 0, 0}, 0}}},
    {RoughPlasticBsdf{.diffuse = glm::vec3(0.02f, 0.2f, 0.1f),
                      .specular = glm::vec3(1, 1, 1),
                      .int_ior = 1.5046f,
                      .ext_ior = 1.000277f,
                      .nonlinear = false,
                      .distribution = DISTRIBUTION_GGX,
                      .alpha = 0.01f},
     {{{0, 0}, {0.4, 1}, {0.006020533, 0.05834953, 0.02927787}, 0.2114439},
      {{0.4, 1}, {0.41, 4.1616}, {17.25183, 17.30391, 17.27497}, 120.5007},
      {{1, -2}, {1.01, 1.1616}, {8.392772, 8.420604, 8.405142}, 47.00456},
      {{1, -2}, {1.45, 0.3}, {0.0003787135, 0.003751175, 0.001877585}, 0.02137623},
      {{1.45, 0.3}, {1.46, 3.4616}, {0.6201029, 0.6216645, 0.6207969}, 1.075383},
      {{1.56, 2.9}, {0.4, 1}, {0.001070451, 0.009504214, 0.00481879}, 0.007973496}}},
    {RoughPlasticBsdf{.diffuse = glm::vec3(0.7f, 0.2f, 0.1f),
                      .specular = glm::vec3(1, 1, 1),
                      .int_ior = 1.5f,
                      .ext_ior = 1,
                      .nonlinear = true,
                      .distribution = DISTRIBUTION_GGX,
                      .alpha = 0.4f},
     {{{0, 0}, {0.4, 1}, {0.1211772, 0.03855732, 0.02560975}, 0.30004},
      {{0.4, 1}, {0.41, 4.1616}, {0.1280048, 0.04626913, 0.03346014}, 0.3301299},
      {{1, -2}, {1.01, 1.1616}, {0.1141645, 0.07305757, 0.0666156}, 0.367533},
      {{1, -2}, {1.45, 0.3}, {0.01167614, 0.004318214, 0.003165136}, 0.04264699},
      {{1.45, 0.3}, {1.46, 3.4616}, {0.3886823, 0.3834184, 0.3825934}, 0.9999639},
      {{1.56, 2.9}, {0.4, 1}, {0.07724714, 0.02543813, 0.01731901}, 0.2168275}}},
    {RoughPlasticBsdf{.diffuse = glm::vec3(0.7f, 0.2f, 0.1f),
                      .specular = glm::vec3(0.5f, 0.7f, 0.9f),
                      .int_ior = 1.5f,
                      .ext_ior = 1,
                      .nonlinear = false,
                      .distribution = DISTRIBUTION_GGX,
                      .alpha = 1},
     {{{0, 0}, {0.4, 1}, {0.07948574, 0.02441192, 0.01388586}, 0.2459149},
      {{0.4, 1}, {0.41, 4.1616}, {0.07694753, 0.02377353, 0.01365236}, 0.2374814},
      {{1, -2}, {1.01, 1.1616}, {0.02980432, 0.01165771, 0.008930757}, 0.1361189},
      {{1, -2}, {1.45, 0.3}, {0.00443557, 0.002354786, 0.002250931}, 0.07103213},
      {{1.45, 0.3}, {1.46, 3.4616}, {0.009161943, 0.01088495, 0.01360374}, 0.1179683},
      {{1.56, 2.9}, {0.4, 1}, {0.02866225, 0.0127963, 0.01094617}, 0.1784077}}},
    {RoughPlasticBsdf{.diffuse = glm::vec3(0.5f, 0.5f, 0.5f),
                      .specular = glm::vec3(1, 1, 1),
                      .int_ior = 1.49f,
                      .ext_ior = 1.000277f,
                      .nonlinear = false,
                      .distribution = DISTRIBUTION_BECKMANN,
                      .alpha = 0.05f},
     {{{0, 0}, {0.4, 1}, {0.1451769, 0.1451769, 0.1451769}, 0.2713512},
      {{0.4, 1}, {0.41, 4.1616}, {1.474764, 1.474764, 1.474764}, 2.830597},
      {{1, -2}, {1.01, 1.1616}, {4.142528, 4.142528, 4.142528}, 7.634282},
      {{1, -2}, {1.45, 0.3}, {0.009632846, 0.009632846, 0.009632846}, 0.03292138},
      {{1.45, 0.3}, {1.46, 3.4616}, {7.210968, 7.210968, 7.210968}, 9.106676},
      {{1.56, 2.9}, {0.4, 1}, {0.03587345, 0.03587345, 0.03587345}, 0.03951556}}},
    {RoughPlasticBsdf{.diffuse = glm::vec3(0.01f, 0.3f, 1),
                      .specular = glm::vec3(1, 1, 1),
                      .int_ior = 1.5f,
                      .ext_ior = 1,
                      .nonlinear = true,
                      .distribution = DISTRIBUTION_BECKMANN,
                      .alpha = 0.2f},
     {{{0, 0}, {0.4, 1}, {0.03210328, 0.07417088, 0.3043886}, 0.3349307},
      {{0.4, 1}, {0.41, 4.1616}, {0.08858744, 0.1304281, 0.359404}, 0.4584571},
      {{1, -2}, {1.01, 1.1616}, {0.2882468, 0.3103682, 0.4314289}, 0.7699819},
      {{1, -2}, {1.45, 0.3}, {0.0001047885, 0.003759123, 0.02375771}, 0.0317548},
      {{1.45, 0.3}, {1.46, 3.4616}, {5.574194, 5.576602, 5.589778}, 6.593672},
      {{1.56, 2.9}, {0.4, 1}, {0.0007202014, 0.02583609, 0.1632845}, 0.1083581}}},
    {RoughPlasticBsdf{.diffuse = glm::vec3(0.772f, 0.175f, 0.262f),
                      .specular = glm::vec3(1, 1, 1),
                      .int_ior = 1.5f,
                      .ext_ior = 1,
                      .nonlinear = true,
                      .distribution = DISTRIBUTION_BECKMANN,
                      .alpha = 0.4f},
     {{{0, 0}, {0.4, 1}, {0.1649659, 0.03957736, 0.05262648}, 0.3049624},
      {{0.4, 1}, {0.41, 4.1616}, {0.1690764, 0.04458754, 0.05754302}, 0.3169458},
      {{1, -2}, {1.01, 1.1616}, {0.1493378, 0.08417072, 0.09095263}, 0.3174343},
      {{1, -2}, {1.45, 0.3}, {0.01528205, 0.002419289, 0.003757909}, 0.03102582},
      {{1.45, 0.3}, {1.46, 3.4616}, {0.8833396, 0.8731253, 0.8741883}, 1.067236},
      {{1.56, 2.9}, {0.4, 1}, {0.116905, 0.01928764, 0.02944662}, 0.1715092}}},
    {RoughPlasticBsdf{.diffuse = glm::vec3(0.5f, 0.5f, 0.5f),
                      .specular = glm::vec3(1, 1, 1),
                      .int_ior = 1,
                      .ext_ior = 1.25f,
                      .nonlinear = false,
                      .distribution = DISTRIBUTION_GGX,
                      .alpha = 0.3f},
     {{{0, 0}, {0.4, 1}, {0.203499, 0.203499, 0.203499}, 0.3132352},
      {{0.4, 1}, {0.41, 4.1616}, {0.2031856, 0.2031856, 0.2031856}, 0.4075397},
      {{1, -2}, {1.01, 1.1616}, {1.487809, 1.487809, 1.487809}, 1.211861},
      {{1, -2}, {1.45, 0.3}, {0.01898592, 0.01898592, 0.01898592}, 0.03501737},
      {{1.45, 0.3}, {1.46, 3.4616}, {1.789081, 1.789081, 1.789081}, 3.398968},
      {{1.56, 2.9}, {0.4, 1}, {0.01490366, 0.01490366, 0.01490366}, 0.1506369}}},
};

TEST(Plastics, AgreeWithMitsuba) {
  for (const MitsubaPlastic& each : kMitsuba) {
    const auto* rough = std::get_if<RoughPlasticBsdf>(&each.bsdf);
    const lobes::Lobe lobe = std::visit([](const auto& bsdf) { return lobes::Lobe(bsdf); }, each.bsdf);
    // Beckmann normals are sampled as they are seen, and Mitsuba's densities have the rational fit of what is
    // seen, off by 0.35%, instead.
    const bool fitted = rough != nullptr && rough->distribution == DISTRIBUTION_BECKMANN;
    for (const MitsubaValue& known : each.values) {
      const vec3 wo = direction(known.wo[0], known.wo[1]), wi = direction(known.wi[0], known.wi[1]);
      const BsdfValue value = lobe.eval(wo, wi);
      const double f_cos[] = {value.f_cos.x, value.f_cos.y, value.f_cos.z};
      // Half vectors that are off by some roundings move a lobe by as many of its widths; both do so.
      const double sharpness = rough != nullptr ? 2e-6 / double(rough->alpha.value) : 0;
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(f_cos[i], known.f_cos[i], (2e-5 + sharpness) * known.f_cos[i] + 1e-9)
            << "at " << known.wo[0] << ", " << known.wi[0];
      EXPECT_NEAR(double(value.pdf), known.pdf, (2e-5 + sharpness + (fitted ? 3.5e-3 : 0)) * known.pdf);
    }
  }
}

/// Fresnel's reflectance from outside, in double.
double fresnel(double cosine, double ior) {
  const double t = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
  const double s = (cosine - ior * t) / (cosine + ior * t), p = (ior * cosine - t) / (ior * cosine + t);
  return 0.5 * (s * s + p * p);
}

TEST(Plastics, ThePolarizedOneHasTheLobeOfTheRoughOneAndASmoothBase) {
  const double ior = double(1.49f) / double(1.000277f);
  for (const int distribution : {DISTRIBUTION_BECKMANN, DISTRIBUTION_GGX})
    for (const float alpha : {0.06f, 0.3f}) {
      PolarizedPlasticBsdf bsdf{.diffuse = glm::vec3(0.9f, 0.5f, 0), .distribution = distribution};
      bsdf.alpha = alpha;
      RoughPlasticBsdf rough{.diffuse = glm::vec3(0.0f), .distribution = distribution};
      rough.alpha = alpha;
      const lobes::Lobe lobe(bsdf), boundary(rough);
      for (const double out : {0.0, 0.4, 1.0, 1.4})
        for (const double in : {0.1, 0.7, 1.2}) {
          const vec3 wo = direction(out, 0.3), wi = direction(in, 2.0);
          const BsdfValue value = lobe.eval(wo, wi), mirror = boundary.eval(wo, wi);
          const double through = (1 - fresnel(double(wo.z), ior)) * (1 - fresnel(double(wi.z), ior));
          const double base = through * double(wi.z) / std::numbers::pi;
          // Between 64 knots a transmittance is off by h^2 |T''| / 8, and T'' is below 16 where the cosine is
          // above 0.13; cos 1.4 is 0.17.
          const double bound = 2 * 16.0 / (8 * 63 * 63) * double(wi.z) / std::numbers::pi + 1e-6;
          EXPECT_NEAR(double(value.f_cos.x - mirror.f_cos.x), 0.9 * base, bound) << out << " " << in;
          EXPECT_NEAR(double(value.f_cos.y - mirror.f_cos.y), 0.5 * base, bound) << out << " " << in;
          EXPECT_NEAR(value.f_cos.z, mirror.f_cos.z, 1e-6f * mirror.f_cos.z);
        }
    }
}

TEST(Plastics, OfTexturedRoughnessAreThoseOfEachRoughness) {
  // Between rows, transmittances are off by up to 0.003, and internal reflectances by 0.0012 (see
  // roughplastic.h): so what leaves the base, d T(wo) T(wi) / (pi ior^2 (1 - d r)), by 0.006 of it at T = 1.
  for (const int distribution : {DISTRIBUTION_BECKMANN, DISTRIBUTION_GGX})
    for (const float alpha : {0.0f, 1e-4f, 3e-4f, 0.01f, 0.07f, 0.21f, 0.5f, 0.95f, 1.0f}) {
      RoughPlasticBsdf bsdf{.diffuse = glm::vec3(0.9f, 0.5f, 0), .distribution = distribution};
      bsdf.alpha = alpha;
      const lobes::Lobe plain(bsdf);
      bsdf.alpha.texture = 0;
      const lobes::Lobe textured(bsdf);
      const double d = 0.9, ior2 = 1.49 * 1.49, internal = 0.6;
      const double most = d / (std::numbers::pi * ior2 * (1 - d * internal));
      for (const double out : {0.0, 0.6, 1.2, 1.5})
        for (const double in : {0.2, 0.9, 1.4}) {
          const vec3 wo = direction(out, 0.3), wi = direction(in, 2.0);
          const BsdfValue a = plain.eval(wo, wi), b = textured.eval(wo, wi);
          const double bound = (0.006 + 0.0012 * d / (1 - d * internal)) * most * double(wi.z);
          EXPECT_NEAR(a.f_cos.x, b.f_cos.x, bound) << alpha << " " << out << " " << in;
          EXPECT_EQ(a.f_cos.z, b.f_cos.z);  // of the boundary alone
        }
    }
}

/// Transmittances at the cosines 1/63, 5/63, 30/63 and 1, and internal reflectances, of Mitsuba 3.9.1 in
/// single precision, recovered from values of black-bordered materials.
struct KnownBoundary {
  RoughBoundary boundary;
  double transmittance[4], internal;
};
const KnownBoundary kBoundaries[] = {
    {{DISTRIBUTION_BECKMANN, 0.1, 1.5}, {0.391193, 0.489425, 0.900802, 0.959998}, 0.580964},
    {{DISTRIBUTION_BECKMANN, 0.4, 1.5}, {0.749112, 0.775390, 0.895720, 0.959343}, 0.488750},
    {{DISTRIBUTION_BECKMANN, 0.05, 1.49}, {0.247393, 0.402994, 0.903811, 0.961274}, 0.579913},
    {{DISTRIBUTION_GGX, 0.01, 1.5}, {0.147837, 0.370676, 0.902505, 0.960001}, 0.587151},
    {{DISTRIBUTION_GGX, 0.1, 1.5}, {0.569286, 0.592173, 0.898727, 0.959559}, 0.551894},
    {{DISTRIBUTION_GGX, 0.4, 1.5}, {0.599714, 0.659704, 0.859902, 0.947476}, 0.348170},
    {{DISTRIBUTION_GGX, 1.0, 1.5}, {0.282177, 0.342448, 0.637279, 0.880810}, 0.117422},
    {{DISTRIBUTION_GGX, 0.3, 0.8}, {0.001191, 0.020786, 0.293814, 0.932485}, 0.023913},
};

TEST(RoughBoundaries, LetThroughWhatMitsubaSays) {
  for (const KnownBoundary& known : kBoundaries) {
    const auto curve = known.boundary.transmittance();
    const std::size_t knots[] = {1, 5, 30, 63};
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(curve[knots[i]], known.transmittance[i], 4e-6);
    EXPECT_NEAR(known.boundary.internal_reflectance(), known.internal, 4e-6);
  }
}

TEST(RoughBoundaries, LetThroughWhatTheyDoNotReflectWhereNothingIsLost) {
  // Nearly smooth: Fresnel's equations.
  const RoughBoundary boundary{DISTRIBUTION_GGX, 1e-4, 1.5};
  const auto curve = boundary.transmittance();
  for (int i = 8; i < CURVE_KNOTS; ++i) {
    const float cosine = float(i) / (CURVE_KNOTS - 1);
    EXPECT_NEAR(curve[std::size_t(i)], 1 - double(dielectric_fresnel(cosine, 1.5f).reflectance), 1e-5);
  }
  EXPECT_NEAR(boundary.internal_reflectance(), smooth_internal_reflectance(1.5), 0.02);
}

TEST(SmoothBoundaries, ReflectDiffuseLightAsTheIntegralSays) {
  // 2 int F(mu) mu dmu, from the side that the light is on.
  for (double ior : {1.1, 1.3, 1.5, 1.9, 0.7}) {
    double sum = 0;
    constexpr int kSteps = 200'000;
    for (int i = 0; i < kSteps; ++i) {
      const double mu = (i + 0.5) / kSteps;
      sum += 2 * mu / kSteps * double(dielectric_fresnel(float(mu), float(1 / ior)).reflectance);
    }
    EXPECT_NEAR(smooth_internal_reflectance(ior), sum, 0.006 * sum) << ior;
  }
}

TEST(MicrofacetDiffuse, ReflectsWhatNoriSays) {
  // Luminance under a white sky, from five angles; to the digits that were published, of Monte Carlo runs.
  const lobes::Lobe lobe(MicrofacetDiffuseBsdf{
      .alpha = 0.1f, .int_ior = 1.5f, .ext_ior = 1.000277f, .diffuse = glm::vec3(0.1f, 0.2f, 0.15f)});
  const double degrees[] = {0, 45, 60, 80, 85}, known[] = {0.207084, 0.215892, 0.247774, 0.430824, 0.519005};
  for (int i = 0; i < 5; ++i) {
    const glm::dvec3 rgb = lobe.reflectance(direction(degrees[i] * std::numbers::pi / 180, 0.3));
    const double luminance = 0.212671 * rgb.x + 0.715160 * rgb.y + 0.072169 * rgb.z;
    EXPECT_NEAR(luminance, known[i], 2e-4 * known[i]) << degrees[i];
  }
}

}  // namespace
}  // namespace penumbra::plastic_test
