// Glass whose refractive index differs between colours: closed forms of a prism, and estimators against each
// other.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <iterator>
#include <numbers>
#include <type_traits>

#include "kernels/features.h"
#include "scenes/refractive_indices.h"
#include "tests/acceptance/media_pieces.h"

namespace penumbra::dispersion_test {
namespace {

using namespace media;

// A dense flint, Schott's SF11.
constexpr double kIndex = 1.78472, kAbbe = 25.76;
constexpr float kAlpha = 0.05f;  // so smooth that microfacets lose next to nothing between each other

enum class Glass { kSmooth, kRough, kOpenPbr };

template <typename Model>
void cover(SceneDescription& scene, Shape& shape, const Model& glass) {
  scene.bsdfs.push_back({"glass", glass});
  shape.front_bsdf = int(scene.bsdfs.size()) - 1;
  if constexpr (std::is_same_v<Model, OpenPbrBsdf>)
    scene.bsdfs.push_back({"glass from inside", *glass.other_side()});
  else
    scene.bsdfs.push_back({"glass from inside", glass.other_side()});
  shape.back_bsdf = int(scene.bsdfs.size()) - 1;
}
template <typename Model>
Model dielectric(double abbe) {
  Model glass;
  glass.int_ior = float(kIndex);
  glass.ext_ior = 1;
  glass.abbe = float(abbe);
  return glass;
}
void cover_with(SceneDescription& scene, Shape& shape, Glass kind, double abbe = kAbbe) {
  if (kind == Glass::kSmooth) cover(scene, shape, dielectric<DielectricBsdf>(abbe));
  if (kind == Glass::kRough) {
    auto rough = dielectric<RoughDielectricBsdf>(abbe);
    rough.distribution = DISTRIBUTION_GGX;
    rough.alpha_u = rough.alpha_v = TexturedNumber(kAlpha);
    cover(scene, shape, rough);
  }
  if (kind != Glass::kOpenPbr) return;
  OpenPbrBsdf glass;
  glass.specular_roughness = TexturedNumber(std::sqrt(kAlpha));
  glass.specular_ior = float(kIndex);
  glass.transmission_weight = TexturedNumber(1.0f);
  glass.dispersion_scale = 0.5f;
  glass.dispersion_abbe = float(0.5 * abbe);
  cover(scene, shape, glass);
}

/// Refractive index by Sellmeier's formula with coefficients of Schott's data sheets; wavelength in
/// micrometres.
double sellmeier(const glm::dvec3& b, const glm::dvec3& c, double wavelength) {
  const double square = wavelength * wavelength;
  double sum = 1;
  for (int i = 0; i < 3; ++i) sum += b[i] * square / (square - c[i]);
  return std::sqrt(sum);
}

TEST(Dispersion, IndicesOfChannelsAreThoseOfGlass) {
  struct Glass {
    double index, abbe;
    glm::dvec3 b, c;
  };
  const Glass glasses[] = {
      {1.5168, 64.17, {1.03961212, 0.231792344, 1.01046945}, {0.00600069867, 0.0200179144, 103.560653}},
      {kIndex, kAbbe, {1.73759695, 0.313747346, 1.89878101}, {0.013188707, 0.0623068142, 155.23629}}};
  const double wavelengths[] = {0.6114, 0.5491, 0.4642};
  for (const Glass& glass : glasses) {
    const glm::dvec3 found = channel_indices(glass.index, glass.abbe);
    // Cauchy's two terms leave out the fourth power of the inverse wavelength, most for blue light in flint:
    // less than a tenth of n_F - n_C.
    const double tolerance = 0.1 * (glass.index - 1) / glass.abbe;
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(found[c], sellmeier(glass.b, glass.c, wavelengths[c]), tolerance)
          << glass.index << " " << c;
  }
}

/// A ray enters a prism of this angle perpendicularly to its first face and leaves through the second. A
/// small square is where light of channel `aim` goes.
constexpr double kApex = std::numbers::pi / 6;
SceneDescription prism(Glass kind, int aim, const IntegratorSettings& integrator) {
  SceneDescription scene = narrow_view(20'000, integrator);
  const double slope = std::tan(kApex);
  std::vector<glm::dvec3> corners;
  for (const double y : {-1.0, 1.0})
    for (const glm::dvec2& at :
         {glm::dvec2(-1, 1), glm::dvec2(1, 1), glm::dvec2(1, 2 - slope), glm::dvec2(-1, 2 + slope)})
      corners.emplace_back(at.x, y, at.y);
  std::vector<glm::dvec3> positions;
  for (const std::array<std::size_t, 4>& side : {std::array<std::size_t, 4>{0, 4, 5, 1},
                                                 {1, 5, 6, 2},
                                                 {2, 6, 7, 3},
                                                 {3, 7, 4, 0},
                                                 {0, 1, 2, 3},
                                                 {4, 7, 6, 5}})
    for (const std::size_t k : {0, 1, 2, 0, 2, 3}) positions.push_back(corners[side[k]]);
  Shape wedge = triangles(positions, 0);
  cover_with(scene, wedge, kind);
  scene.shapes.push_back(wedge);

  const glm::dvec3 normal(std::sin(kApex), 0, std::cos(kApex)), along(-std::cos(kApex), 0, std::sin(kApex));
  const double sine = channel_indices(kIndex, kAbbe)[aim] * std::sin(kApex);
  const glm::dvec3 out = sine * along + std::sqrt(1 - sine * sine) * normal;
  constexpr double kDistance = 10, kHalf = 0.01;
  const glm::dvec3 across(out.z, 0, -out.x), up(0, 1, 0);
  const glm::dvec3 middle = glm::dvec3(0, 0, 2) + kDistance * out;
  Shape target = parallelogram(middle - kHalf * (across + up), 2 * kHalf * up, 2 * kHalf * across, 0, 1.0f);
  scene.bsdfs.push_back({"black", DiffuseBsdf{.reflectance = TexturedColour(glm::vec3(0))}});
  target.front_bsdf = target.back_bsdf = int(scene.bsdfs.size()) - 1;
  scene.shapes.push_back(target);
  return scene;
}

TEST(Dispersion, PrismDeviatesEachChannelByItsIndex) {
  const glm::dvec3 indices = channel_indices(kIndex, kAbbe);
  const IntegratorSettings path{.method = PathIntegrator{.max_depth = 3}},
      whitted{.method = WhittedIntegrator{.max_depth = 3}};
  for (int aim = 0; aim < 3; ++aim) {
    SCOPED_TRACE(aim);
    const double n = indices[aim], cosine = std::sqrt(1 - n * n * 0.25);
    glm::dvec3 expected(0);
    expected[aim] = (1 - reflectance(1, n)) * (1 - reflectance(cosine, n));
    for (const IntegratorSettings& integrator : {path, volpath(DirectSampling::kMis, 3), whitted})
      expect_colour(prism(Glass::kSmooth, aim, integrator), expected, 1e-4);
  }
}

/// A matt floor that the sky and a light light through glass.
SceneDescription lit_through_glass(Glass kind, const IntegratorSettings& integrator) {
  SceneDescription scene = empty_scene(16, 16, 300, 3);
  scene.camera = look_at({0.2, 1, -3}, {0, 0, 0}, {0, 1, 0}, 40);
  scene.integrator = integrator;
  const int grey = add_diffuse(scene, 0.6f);
  scene.shapes.push_back(parallelogram({-2, -1, -2}, {0, 0, 4}, {4, 0, 0}, grey));
  scene.shapes.push_back(parallelogram({0.7, 2, 0.7}, {-1.4, 0, 0}, {0, 0, -1.4}, grey, 3.0f));
  Shape ball = sphere({0, 0, 0}, 0.7, 0);
  cover_with(scene, ball, kind, 5.0);
  scene.shapes.push_back(ball);
  scene.emitters.emplace_back(ConstantEnvironment{});
  return scene;
}

TEST(Dispersion, TechniquesAgree) {
  const auto path = [](DirectSampling sampling, int max_depth = 6) {
    return IntegratorSettings{.method = PathIntegrator{.max_depth = max_depth, .direct_sampling = sampling}};
  };
  for (const Glass kind : {Glass::kSmooth, Glass::kRough, Glass::kOpenPbr}) {
    SCOPED_TRACE(int(kind));
    const SceneDescription by_path = lit_through_glass(kind, path(DirectSampling::kMis));
    expect_alike(by_path, lit_through_glass(kind, path(DirectSampling::kBsdfOnly)));
    expect_alike(by_path, lit_through_glass(kind, {.method = WhittedIntegrator{.max_depth = 6}}));
    expect_alike(lit_through_glass(kind, {.method = DirectIntegrator{}}),
                 lit_through_glass(kind, path(DirectSampling::kMis, 2)));
  }
  expect_alike(lit_through_glass(Glass::kRough, path(DirectSampling::kMis)),
               lit_through_glass(Glass::kOpenPbr, path(DirectSampling::kMis)));
}

/// Also where no direction is sampled, and there is one light.
TEST(Dispersion, EachSampleOfALightChoosesItsChannel) {
  const auto by = [](const IntegratorSettings& integrator) {
    SceneDescription scene = lit_through_glass(Glass::kRough, integrator);
    scene.emitters.clear();
    return scene;
  };
  const auto a = block_estimate(by({.method = DirectIntegrator{.emitter_samples = 4, .bsdf_samples = 1}}), 8,
                                10, 4, big_passes()),
             b = block_estimate(by({.method = PathIntegrator{.max_depth = 2}}), 8, 100, 4, big_passes());
  const statistics::ImageTestResult test = statistics::z_test(a, b, {.significance = media::kSignificance});
  EXPECT_LE(std::abs(test.worst), test.limit) << test.summary();
}

TEST(Dispersion, FurnaceStaysWhite) {
  SceneDescription scene = narrow_view(20'000, {.method = PathIntegrator{}});
  Shape ball = sphere({0.2, 0.3, 3}, 1, 0);
  cover_with(scene, ball, Glass::kSmooth);
  scene.shapes.push_back(ball);
  scene.emitters.emplace_back(ConstantEnvironment{});
  expect_colour(scene, glm::dvec3(1), 1e-4);
}

TEST(Dispersion, IsLeftOutWhereNothingDisperses) {
  SceneDescription scene = narrow_view(1);
  Shape ball = sphere({0, 0, 3}, 1, 0);
  cover_with(scene, ball, Glass::kSmooth, 0.0);
  scene.shapes.push_back(ball);
  EXPECT_EQ(build_or_throw(scene).header.features & FEATURE_DISPERSION, 0u);
}

}  // namespace
}  // namespace penumbra::dispersion_test
