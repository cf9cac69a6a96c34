// Polygon lights that reflect. A light is flat, so it does not illuminate itself, although rounding puts
// points of its surface on either side of its plane: such a surface must reflect what it would reflect if it
// did not emit.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/shadowed_polygon.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra::polygon_own_surface_test {
namespace {

using glm::dvec3;

constexpr double kSignificance = 0.01;
constexpr double kRounding = 32.0 / (1 << 24);  ///< relative; see furnace_test.cpp
constexpr int kWidth = 32, kHeight = 24;
constexpr float kOwnRadiance = 3, kAlbedo = 0.5f;

struct OwnSurface {
  std::string name;
  bool two_sided, from_front;
  bool beside_another;  ///< a second light shines on the surface; else there is nothing else
  BsdfModel bsdf = DiffuseBsdf{glm::vec3(kAlbedo)};
};
void PrintTo(const OwnSurface& tested, std::ostream* out) { *out << tested.name; }

/// A slanted rectangle in the camera's view, which emits if `shines`; its emission itself is hidden.
SceneDescription scene_of(const OwnSurface& tested, bool shines, const IntegratorSettings& integrator) {
  SceneDescription scene = empty_scene(kWidth, kHeight, 1, 1);
  const dvec3 centre(0.31, 0.17, -0.23), normal = glm::normalize(dvec3(0.3, 0.8, -0.45));
  const dvec3 u = glm::normalize(glm::cross(normal, dvec3(0.1, 0.2, 1))), v = glm::cross(normal, u);
  const dvec3 up = tested.from_front ? normal : -normal;
  scene.camera = look_at(centre + 2.0 * up + 1.3 * u - 0.4 * v, centre, v, 25);
  scene.bsdfs.push_back({"surface", tested.bsdf});
  Shape surface = parallelogram(centre - u - 0.9 * v, 2.1 * u, 1.9 * v, 0);
  surface.back_bsdf = 0;
  if (shines) {
    surface.radiance = glm::vec3(kOwnRadiance);
    surface.two_sided_emission = tested.two_sided;
  }
  scene.shapes.push_back(surface);
  if (tested.beside_another)
    scene.shapes.push_back(
        parallelogram(centre + 1.1 * up - 1.4 * u - 0.3 * v, 0.5 * up, 0.8 * v, kBlackBsdf, 1.0f));
  if (tested.beside_another) scene.shapes.back().two_sided_emission = true;
  scene.integrator = integrator;
  scene.integrator.hide_emitters = true;
  return scene;
}

class OwnSurfaces : public testing::TestWithParam<OwnSurface> {};

TEST_P(OwnSurfaces, ClosedFormIsThatOfTheOtherLights) {
  IntegratorSettings integrator;
  use(integrator, IntegratorKind::kPolygonAnalytic);
  const FilmAccumulator shining = render_or_throw(scene_of(GetParam(), true, integrator));
  const FilmAccumulator dark = render_or_throw(scene_of(GetParam(), false, integrator));
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      ASSERT_EQ(shining.at(x, y).mean[1], dark.at(x, y).mean[1]) << x << ", " << y;
      if (GetParam().beside_another) ASSERT_GT(dark.at(x, y).mean[1], 0);
    }
}

struct Method {
  std::string name;
  IntegratorSettings integrator;
};

/// Those of no bias.
std::vector<Method> methods() {
  using enum EmitterSampling;
  std::vector<Method> all;
  for (EmitterSampling sampling : {kArea, kSolidAngle, kProjected})
    for (LightChoice choice : {LightChoice::kPower, LightChoice::kAnalytic}) {
      const bool by_power = choice == LightChoice::kPower;
      const std::string how =
          " by sampling " + std::to_string(int(sampling)) + (by_power ? ", by power" : ", by contribution");
      const auto add = [&](const char* name, IntegratorSettings integrator) {
        param::light_choice(integrator) = choice;
        param::emitter_sampling(integrator) = sampling;
        all.push_back({name + how, integrator});
      };
      IntegratorSettings area = emitter_only(sampling, 2);
      add("emitter samples", area);
      use(area, IntegratorKind::kPolygonArea);
      add("polygon_area", area);
      add("polygon_cv, alpha 0.5", polygon_cv(0.5f, sampling, 2));
      add("polygon_cv, alpha 1", polygon_cv(1.0f, sampling, 2));
      add("polygon_cv, alpha auto", polygon_cv(std::nullopt, sampling, 2));
      IntegratorSettings paths =
          path_integrator(by_power ? DirectSampling::kMis : DirectSampling::kEmitterOnly);
      param::max_depth(paths) = 3;
      add("paths", paths);
      param::next_event(paths) = NextEvent::kCv;
      param::alpha(paths) = 1.0f;
      add("paths with control variates", paths);
      if (by_power) add("MIS", direct_integrator(1, 1));
    }
  return all;
}

/// The pixels' means, less those of the scene where the surface does not emit.
statistics::Sample excess(const OwnSurface& tested, const IntegratorSettings& integrator,
                          std::uint32_t seed) {
  constexpr std::uint32_t kSamples = 16;
  const auto film_of = [&](bool shines) {
    SceneDescription scene = scene_of(tested, shines, integrator);
    scene.sampler.spp = kSamples;
    scene.sampler.seed = 2 * seed + (shines ? 1 : 0);
    return render_or_throw(scene);
  };
  const FilmAccumulator shining = film_of(true);
  std::optional<FilmAccumulator> dark;
  if (tested.beside_another) dark.emplace(film_of(false));  // else there are no lights
  statistics::Sample differences;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      differences.add(double(shining.at(x, y).mean[1]) - (dark ? dark->at(x, y).mean[1] : 0.0));
  return differences;
}

TEST_P(OwnSurfaces, EveryMethodHasTheMeanOfTheOtherLights) {
  ManyTests tests;
  std::uint32_t seed = 1;
  for (const auto& [name, integrator] : methods()) {
    const statistics::Sample differences = excess(GetParam(), integrator, seed++);
    if (GetParam().beside_another)
      tests.add(statistics::t_test(differences, 0, kRounding), name);
    else
      EXPECT_NEAR(differences.mean(), 0, kRounding * kOwnRadiance) << name;
  }
  if (GetParam().beside_another) tests.expect_passed(kSignificance);
}

const PhongBsdf kGlossy{glm::vec3(0.3f), glm::vec3(0.4f), 10};

INSTANTIATE_TEST_SUITE_P(Cases, OwnSurfaces,
                         testing::Values(OwnSurface{"TwoSidedFront", true, true, true},
                                         OwnSurface{"TwoSidedBack", true, false, true},
                                         OwnSurface{"TwoSidedAlone", true, true, false},
                                         OwnSurface{"OneSidedFront", false, true, true},
                                         OwnSurface{"OneSidedBack", false, false, true},
                                         OwnSurface{"OneSidedBackAlone", false, false, false},
                                         OwnSurface{"GlossyTwoSided", true, true, true, kGlossy},
                                         OwnSurface{"GlossyOneSidedBack", false, false, true, kGlossy}),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace penumbra::polygon_own_surface_test
