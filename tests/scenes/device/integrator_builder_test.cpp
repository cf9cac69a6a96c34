// The header of the device scene for an integrator's settings and a scene's lights, the features that they
// need, and contradictory settings.
#include "scenes/device/integrator_builder.h"
#include "kernels/math/math.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <climits>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scenes/device/device_scene_builder.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

using glm::dvec3;
using ::testing::AllOf;
using ::testing::HasSubstr;
using enum IntegratorKind;
using S = SceneDescription;
using Change = std::function<void(S&)>;

Shape square(double x, glm::vec3 radiance = glm::vec3(1)) {
  Mesh mesh;
  mesh.positions = {dvec3(x, 1, 0), dvec3(x + 0.5, 1, 0), dvec3(x + 0.5, 1, 0.5), dvec3(x, 1, 0.5)};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  Shape shape;
  shape.name = "square";
  shape.geometry = mesh;
  shape.radiance = radiance;
  return shape;
}

Shape sphere_light() {
  Shape shape;
  shape.name = "sphere";
  shape.geometry = Sphere{dvec3(0, 3, 0), 0.5};
  shape.radiance = glm::vec3(1);
  return shape;
}

/// A diffuse floor under a square.
S under_a_square(IntegratorKind kind) {
  S scene;
  scene.source = "some-scene.xml";
  scene.bsdfs.push_back({"grey", DiffuseBsdf{glm::vec3(0.5f)}});
  Shape floor = square(-1);
  for (dvec3& p : std::get<Mesh>(floor.geometry).positions) p.y = 0;
  floor.radiance.reset();
  floor.front_bsdf = floor.back_bsdf = 0;
  scene.shapes = {floor, square(0)};
  use(scene.integrator, kind);
  return scene;
}

Expected<DeviceScene> try_build(const S& scene, bool layers) {
  DeviceSceneOptions options;
  options.feature_layers = layers;
  return build_device_scene(scene, options);
}

SceneHeader header(IntegratorKind kind, const Change& change = {}, bool layers = true) {
  S scene = under_a_square(kind);
  if (change) change(scene);
  const auto built = try_build(scene, layers);
  if (!built) throw std::runtime_error(built.error().message);
  const auto checked = check_device_scene(*built);
  EXPECT_TRUE(checked) << checked.error().message;
  return built->header;
}

void phong(S& scene) { scene.bsdfs.push_back({"glossy", PhongBsdf{}}); }
void by_area(S& scene) { param::emitter_sampling(scene.integrator) = EmitterSampling::kArea; }
void by_projection(S& scene) { param::emitter_sampling(scene.integrator) = EmitterSampling::kProjected; }
void two_colours(S& scene) { scene.shapes.push_back(square(2, glm::vec3(1, 2, 3))); }
void with_sphere(S& scene) { scene.shapes.push_back(sphere_light()); }
void by_power(S& scene) { param::light_choice(scene.integrator) = LightChoice::kPower; }
void by_tree(S& scene) { param::light_choice(scene.integrator) = LightChoice::kTree; }
void by_contribution(S& scene) { param::light_choice(scene.integrator) = LightChoice::kAnalytic; }
void with_cv(S& scene) { param::next_event(scene.integrator) = NextEvent::kCv; }
void ems(S& scene) { param::direct_sampling(scene.integrator) = DirectSampling::kEmitterOnly; }
void mats(S& scene) { param::direct_sampling(scene.integrator) = DirectSampling::kBsdfOnly; }
void no_bsdf_samples(S& scene) { param::bsdf_samples(scene.integrator) = 0; }

Change all(std::vector<Change> changes) {
  return [changes = std::move(changes)](S& scene) {
    for (const Change& change : changes) change(scene);
  };
}
/// Nothing for integrators without the parameter.
Change where_there(const Change& change) {
  return [=](S& scene) {
    try {
      change(scene);
    } catch (const std::logic_error&) {
    }
  };
}
Change with_alpha(float alpha) {
  return [=](S& scene) { param::alpha(scene.integrator) = alpha; };
}

// --- estimators

struct EstimatorCase {
  const char* what;
  IntegratorKind kind;
  Change change;
  int estimator;
  float alpha;
  int choice;
};

TEST(IntegratorBuilder, EstimatorsAndChoices) {
  const EstimatorCase cases[] = {
      {"direct", kDirect, {}, ESTIMATOR_SAMPLES, 1, CHOICE_POWER},
      {"direct, emitters alone", kDirect, no_bsdf_samples, ESTIMATOR_SAMPLES, 1, CHOICE_POWER},
      {"path", kPath, {}, ESTIMATOR_SAMPLES, 1, CHOICE_POWER},
      {"path, emitters alone", kPath, ems, ESTIMATOR_SAMPLES, 1, CHOICE_POWER},
      {"alpha without a control variate", kPath, with_alpha(0.5f), ESTIMATOR_SAMPLES, 1, CHOICE_POWER},
      {"direct, two lights", kDirect, with_sphere, ESTIMATOR_SAMPLES, 1, CHOICE_TREE},
      {"path, two lights", kPath, with_sphere, ESTIMATOR_SAMPLES, 1, CHOICE_TREE},
      {"whitted, two lights", kWhitted, with_sphere, ESTIMATOR_SAMPLES, 1, CHOICE_TREE},
      {"path, two lights by power", kPath, all({with_sphere, by_power}), ESTIMATOR_SAMPLES, 1, CHOICE_POWER},
      {"path, two lights, directions alone", kPath, all({with_sphere, mats}), ESTIMATOR_SAMPLES, 1,
       CHOICE_POWER},
      {"cv, by hierarchy", kPolygonCv, all({with_alpha(1), with_sphere, by_tree}), ESTIMATOR_ALPHA, 1,
       CHOICE_TREE},
      {"analytic", kPolygonAnalytic, {}, ESTIMATOR_ALPHA, 1, CHOICE_POWER},
      {"area", kPolygonArea, {}, ESTIMATOR_SAMPLES, 1, CHOICE_POWER},
      {"area by contribution", kPolygonArea, by_contribution, ESTIMATOR_ALPHA, 0, CHOICE_ANALYTIC},
      {"direct by contribution", kDirect, all({no_bsdf_samples, by_contribution}), ESTIMATOR_ALPHA, 0,
       CHOICE_ANALYTIC},
      {"cv, alpha given", kPolygonCv, with_alpha(0.25f), ESTIMATOR_ALPHA, 0.25f, CHOICE_ANALYTIC},
      {"cv, alpha below 0", kPolygonCv, with_alpha(-2), ESTIMATOR_ALPHA, -2, CHOICE_ANALYTIC},
      {"cv, alpha 1", kPolygonCv, with_alpha(1), ESTIMATOR_ALPHA, 1, CHOICE_ANALYTIC},
      {"cv, by power", kPolygonCv, all({with_alpha(1), by_power}), ESTIMATOR_ALPHA, 1, CHOICE_POWER},
      {"cv, fitted", kPolygonCv, {}, ESTIMATOR_AUTO, 1, CHOICE_ANALYTIC},
      {"cv, nothing to fit", kPolygonCv, by_projection, ESTIMATOR_ALPHA, 0, CHOICE_ANALYTIC},
      {"cv, Phong", kPolygonCv, all({by_projection, phong}), ESTIMATOR_AUTO, 1, CHOICE_ANALYTIC},
      {"cv, by area", kPolygonCv, by_area, ESTIMATOR_AUTO, 1, CHOICE_ANALYTIC},
      {"cv, two colours", kPolygonCv, all({by_projection, two_colours}), ESTIMATOR_AUTO, 1, CHOICE_ANALYTIC},
      {"cv, other lights", kPolygonCv, all({by_projection, with_sphere}), ESTIMATOR_AUTO, 1, CHOICE_ANALYTIC},
      {"cv, auto by power", kPolygonCv, all({by_projection, by_power}), ESTIMATOR_AUTO, 1, CHOICE_POWER},
      {"path cv", kPath, all({with_cv, phong}), ESTIMATOR_AUTO, 1, CHOICE_ANALYTIC},
      {"path cv, alpha given", kPath, all({with_cv, with_alpha(0.5f)}), ESTIMATOR_ALPHA, 0.5f,
       CHOICE_ANALYTIC},
      // The BSDF's samples find the sphere: multiple importance sampling needs the density of its choice.
      {"path cv, other lights", kPath, all({with_cv, with_sphere}), ESTIMATOR_AUTO, 1, CHOICE_POWER},
      {"path cv, other lights, emitters alone", kPath, all({with_cv, with_sphere, ems}), ESTIMATOR_AUTO, 1,
       CHOICE_ANALYTIC},
      {"path by contribution", kPath, all({ems, by_contribution}), ESTIMATOR_ALPHA, 0, CHOICE_ANALYTIC}};
  for (const EstimatorCase& tested : cases) {
    const SceneHeader h = header(tested.kind, tested.change);
    EXPECT_EQ(h.integrator.estimator, tested.estimator) << tested.what;
    EXPECT_EQ(h.integrator.light_choice, tested.choice) << tested.what;
    if (tested.estimator == ESTIMATOR_ALPHA) {
      EXPECT_EQ(h.adjustable.alpha, tested.alpha) << tested.what;
    }
    // The tables are there if anything reads them, and only then.
    const bool needed = tested.estimator != ESTIMATOR_SAMPLES || tested.choice == CHOICE_ANALYTIC;
    EXPECT_EQ((h.features & FEATURE_POLYGONS) != 0, needed) << tested.what;
    EXPECT_EQ(h.tables.polygons.count > 0, needed) << tested.what;
    EXPECT_EQ(h.tables.polygon_corners.count > 0, needed) << tested.what;
  }
}

TEST(IntegratorBuilder, WithoutLayersSamplesAloneNeedNoClosedForm) {
  EXPECT_EQ(header(kPolygonCv, by_projection, false).integrator.estimator, ESTIMATOR_SAMPLES);
  EXPECT_EQ(header(kPolygonCv, by_projection, false).integrator.light_choice, CHOICE_ANALYTIC);
  EXPECT_EQ(header(kPolygonArea, by_contribution, false).integrator.estimator, ESTIMATOR_SAMPLES);
  EXPECT_EQ(header(kPath, all({ems, by_contribution}), false).integrator.estimator, ESTIMATOR_SAMPLES);
  EXPECT_EQ(header(kPolygonCv, all({by_projection, phong}), false).integrator.estimator, ESTIMATOR_AUTO);
  EXPECT_EQ(header(kPolygonCv, with_alpha(1), false).integrator.estimator, ESTIMATOR_ALPHA);
  EXPECT_EQ(header(kPolygonAnalytic, {}, false).integrator.estimator, ESTIMATOR_ALPHA);
}

TEST(IntegratorBuilder, ManyPolygonsAreNotAllEvaluatedByDefault) {
  const auto count = [](int lights) {
    return [=](S& scene) {
      scene.shapes.resize(1);
      for (int i = 0; i < lights; ++i) scene.shapes.push_back(square(i));
    };
  };
  EXPECT_EQ(header(kPolygonCv, count(256)).integrator.light_choice, CHOICE_ANALYTIC);
  EXPECT_EQ(header(kPolygonCv, count(257)).integrator.light_choice, CHOICE_POWER);
  EXPECT_EQ(header(kPolygonCv, count(257)).integrator.estimator, ESTIMATOR_AUTO);
  EXPECT_EQ(header(kPolygonCv, all({count(257), by_contribution})).integrator.light_choice, CHOICE_ANALYTIC);
}

// --- samples

TEST(IntegratorBuilder, NumbersOfSamples) {
  const auto samples = [](IntegratorKind kind) {
    const Change emitters = [](S& scene) { param::emitter_samples(scene.integrator) = 3; };
    const Change bsdfs = [](S& scene) { param::bsdf_samples(scene.integrator) = 5; };
    const Change shadow_rays = [](S& scene) { param::vis_samples(scene.integrator) = 7; };
    const SceneHeader h =
        header(kind, all({where_there(emitters), where_there(bsdfs), where_there(shadow_rays)}));
    return std::pair(h.integrator.emitter_samples, h.integrator.bsdf_samples);
  };
  EXPECT_EQ(samples(kDirect), std::pair(3, 5));
  EXPECT_EQ(samples(kPolygonArea), std::pair(3, 0));
  EXPECT_EQ(samples(kPolygonCv), std::pair(7, 0));
  EXPECT_EQ(samples(kPolygonAnalytic), std::pair(0, 0));
}

TEST(IntegratorBuilder, HowLightsAreSampled) {
  const std::uint64_t both = FEATURE_SOLID_ANGLE | FEATURE_PROJECTED;
  const auto sampling = [&](IntegratorKind kind, const Change& change = {}) {
    return header(kind, change).features & both;
  };
  // By what pays: the square is as large as the floor under it.
  EXPECT_EQ(sampling(kDirect), std::uint64_t(FEATURE_SOLID_ANGLE));
  EXPECT_EQ(sampling(kPath), std::uint64_t(FEATURE_SOLID_ANGLE));
  const Change tiny = [](S& s) {
    for (dvec3& p : std::get<Mesh>(s.shapes[1].geometry).positions) p = dvec3(0.01 * p.x, p.y, 0.01 * p.z);
  };
  EXPECT_EQ(sampling(kDirect, tiny), 0u);
  EXPECT_EQ(sampling(kPath, tiny), 0u);
  EXPECT_EQ(sampling(kDirect, by_area), 0u);
  EXPECT_EQ(sampling(kPolygonArea), 0u);
  EXPECT_EQ(sampling(kPolygonAnalytic), 0u);
  EXPECT_EQ(sampling(kPolygonCv), std::uint64_t(FEATURE_SOLID_ANGLE));
  EXPECT_EQ(sampling(kPath, with_cv), std::uint64_t(FEATURE_SOLID_ANGLE));
  EXPECT_EQ(sampling(kPolygonCv, by_projection), std::uint64_t(FEATURE_PROJECTED));
  EXPECT_EQ(sampling(kPolygonCv, by_area), 0u);
  EXPECT_EQ(sampling(kPolygonArea,
                     [](S& s) { param::emitter_sampling(s.integrator) = EmitterSampling::kSolidAngle; }),
            std::uint64_t(FEATURE_SOLID_ANGLE));
  // A shape knows better.
  EXPECT_EQ(sampling(kPolygonCv, [](S& s) { s.shapes[1].sampling = EmitterSampling::kArea; }), 0u);
  EXPECT_EQ(sampling(kPolygonArea, [](S& s) { s.shapes[1].sampling = EmitterSampling::kProjected; }),
            std::uint64_t(FEATURE_PROJECTED));
}

TEST(IntegratorBuilder, ShadowsAreLeftOutOnlyWhereThatIsASetting) {
  const auto traced = [](IntegratorKind kind, bool wanted) {
    const Change change = [=](S& scene) { param::trace_shadows(scene.integrator) = wanted; };
    return header(kind, where_there(change)).integrator.trace_shadows;
  };
  for (const IntegratorKind kind : {kDirect, kPath, kPolygonAnalytic, kPolygonArea, kPolygonCv}) {
    EXPECT_EQ(traced(kind, true), 1);
    EXPECT_EQ(traced(kind, false), kind == kDirect || kind == kPolygonArea ? 0 : 1);
  }
}

TEST(IntegratorBuilder, DepthsAndFlags) {
  EXPECT_EQ(header(kPath).integrator.max_depth, INT_MAX);
  EXPECT_EQ(header(kPath, [](S& s) { param::rr_depth(s.integrator) = INT_MAX; }).integrator.rr_depth, 1024)
      << "a path without end must end";
  const SceneHeader finite = header(kPath, [](S& s) {
    param::max_depth(s.integrator) = 7;
    param::rr_depth(s.integrator) = 5000;
  });
  EXPECT_EQ(finite.integrator.max_depth, 7);
  EXPECT_EQ(finite.integrator.rr_depth, 5000);
  for (const IntegratorKind kind : {kDirect, kPath, kPolygonAnalytic, kPolygonArea, kPolygonCv}) {
    EXPECT_EQ(header(kind).integrator.hide_emitters, 0);
    EXPECT_EQ(header(kind, [](S& s) { s.integrator.hide_emitters = true; }).integrator.hide_emitters, 1);
    EXPECT_EQ(header(kind).integrator.kind, kind == kPath ? INTEGRATOR_PATH : INTEGRATOR_DIRECT);
    EXPECT_EQ(header(kind).features & (FEATURE_PATH | FEATURE_DIRECT),
              std::uint64_t(kind == kPath ? FEATURE_PATH : FEATURE_DIRECT));
  }
}

TEST(IntegratorBuilder, EachIntegratorHasItsKernelAndFeature) {
  const std::pair<int, std::uint32_t> expected[] = {
      {INTEGRATOR_DIRECT, FEATURE_DIRECT},       {INTEGRATOR_PATH, FEATURE_PATH},
      {INTEGRATOR_DIRECT, FEATURE_DIRECT},       {INTEGRATOR_DIRECT, FEATURE_DIRECT},
      {INTEGRATOR_DIRECT, FEATURE_DIRECT},       {INTEGRATOR_WHITTED, FEATURE_WHITTED},
      {INTEGRATOR_OCCLUSION, FEATURE_OCCLUSION}, {INTEGRATOR_OCCLUSION, FEATURE_OCCLUSION},
      {INTEGRATOR_PATH, FEATURE_PATH},           {INTEGRATOR_OCCLUSION, FEATURE_OCCLUSION},
      {INTEGRATOR_PATH, FEATURE_PATH},           {INTEGRATOR_PATH, FEATURE_PATH}};
  ASSERT_EQ(std::size(expected), integrator_methods().size());
  for (std::size_t i = 0; i < std::size(expected); ++i) {
    const SceneHeader h = header(IntegratorKind(i));
    EXPECT_EQ(h.integrator.kind, expected[i].first) << i;
    EXPECT_EQ(h.features & (FEATURE_PATH | FEATURE_DIRECT | FEATURE_WHITTED | FEATURE_OCCLUSION),
              expected[i].second)
        << i;
  }
}

TEST(IntegratorBuilder, PhotonMapsHaveTheirRadii) {
  const auto with = [](IntegratorMethod method) {
    return header(kPath, [=](S& s) { s.integrator.method = method; });
  };
  const SceneHeader fixed = with(PhotonMapIntegrator{.global_photons = 10,
                                                     .caustic_photons = 20,
                                                     .volume_photons = 30,
                                                     .lookup_size = 40,
                                                     .final_gather = true});
  EXPECT_NE(fixed.features & FEATURE_PHOTONS, 0u);
  EXPECT_EQ(fixed.integrator.photons, PHOTONS_FIXED);
  EXPECT_EQ(fixed.integrator.surface_photons, 10);
  EXPECT_EQ(fixed.integrator.caustic_photons, 20);
  EXPECT_EQ(fixed.integrator.volume_photons, 30);
  EXPECT_EQ(fixed.integrator.lookup_size, 40);
  EXPECT_EQ(fixed.integrator.gathering, GATHER_SECOND);
  // The floor reaches from -1 to -0.5 and the square, one above it, from 0 to 0.5.
  const double radius = 0.5 * glm::length(dvec3(1.5, 1, 0.5));
  EXPECT_FLOAT_EQ(fixed.integrator.surface_radius, float(0.05 * radius));
  EXPECT_FLOAT_EQ(fixed.integrator.caustic_radius, float(0.0125 * radius));
  EXPECT_FLOAT_EQ(fixed.integrator.volume_radius, float(0.05 * radius));
  EXPECT_GT(fixed.integrator.emission_radius, radius);
  const SceneHeader one_radius = with(PhotonMapIntegrator{.photon_radius = 0.25f});
  for (const float each : {one_radius.integrator.surface_radius, one_radius.integrator.caustic_radius,
                           one_radius.integrator.volume_radius})
    EXPECT_EQ(each, 0.25f);

  const SceneHeader progressive =
      with(ProgressivePhotonIntegrator{.photon_count = 50, .initial_radius = 0.5f});
  EXPECT_NE(progressive.features & FEATURE_PHOTONS, 0u);
  EXPECT_EQ(progressive.integrator.photons, PHOTONS_PROGRESSIVE);
  EXPECT_EQ(progressive.integrator.surface_photons, 50);
  EXPECT_EQ(progressive.integrator.caustic_photons, 0);
  EXPECT_EQ(progressive.integrator.volume_photons, 50);
  EXPECT_EQ(progressive.integrator.surface_radius, 0.5f);
  EXPECT_EQ(progressive.integrator.gathering, GATHER_FIRST);
  EXPECT_EQ(with(ProgressivePhotonIntegrator{.caustics_only = true}).integrator.gathering, GATHER_CAUSTICS);
  EXPECT_EQ(progressive.integrator.radius_alpha, 0.7f);
  EXPECT_EQ(with(ProgressivePhotonIntegrator{.alpha = std::nullopt}).integrator.radius_alpha, 2.0f / 3.0f);
  EXPECT_GT(with(ProgressivePhotonIntegrator{}).integrator.surface_radius, 0.0f) << "automatic";
  EXPECT_EQ(header(kPath).integrator.photons, PHOTONS_NONE);
  EXPECT_EQ(header(kPath).features & FEATURE_PHOTONS, 0u);
}

TEST(IntegratorBuilder, PhotonsNeedALight) {
  for (const IntegratorKind kind : {kPhotonMap, kProgressivePhoton}) {
    S scene = under_a_square(kind);
    scene.shapes[1].radiance = glm::vec3(0);
    const auto built = try_build(scene, true);
    ASSERT_FALSE(built);
    EXPECT_THAT(built.error().message, HasSubstr("photon mapping needs a light that is not black"));
  }
}

TEST(IntegratorBuilder, WhittedSamplesDirectionsAndLights) {
  const IntegratorParameters by_default = header(kWhitted).integrator;
  EXPECT_EQ(by_default.bsdf_samples, 1);
  EXPECT_EQ(by_default.bsdf_sampling, DIRECTION_COSINE);
  EXPECT_EQ(by_default.branch_depth, 4);
  EXPECT_EQ(by_default.max_depth, INT_MAX);
  EXPECT_EQ(by_default.direct_sampling, SAMPLING_MIS);
  const IntegratorParameters changed = header(kWhitted, [](S& s) {
                                         param::indirect_samples(s.integrator) = 3;
                                         param::indirect_sampling(s.integrator) = IndirectSampling::kUniform;
                                         param::branch_depth(s.integrator) = 2;
                                         param::max_depth(s.integrator) = 7;
                                       }).integrator;
  EXPECT_EQ(changed.bsdf_samples, 3);
  EXPECT_EQ(changed.bsdf_sampling, DIRECTION_UNIFORM);
  EXPECT_EQ(changed.branch_depth, 2);
  EXPECT_EQ(changed.max_depth, 7);
  EXPECT_EQ(header(kWhitted, with_cv).integrator.estimator, ESTIMATOR_AUTO);
  EXPECT_EQ(header(kPath).integrator.bsdf_sampling, DIRECTION_BSDF) << "the default of direct";
}

TEST(IntegratorBuilder, RaysOfOcclusionHaveALength) {
  const auto length = [](IntegratorKind kind, float given) {
    return header(kind, [=](S& s) { param::ray_length(s.integrator) = given; }).integrator.ray_length;
  };
  for (const IntegratorKind kind : {kAmbientOcclusion, kReflectionOcclusion}) {
    EXPECT_EQ(length(kind, 2.5f), 2.5f);
    EXPECT_EQ(length(kind, 0), NO_LIMIT);
    glm::dvec3 low(1e30), high(-1e30);
    for (const Shape& shape : under_a_square(kind).shapes)
      for (const dvec3& p : std::get<Mesh>(shape.geometry).positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
      }
    EXPECT_EQ(length(kind, -1), float(0.25 * glm::length(high - low)));
  }
  EXPECT_EQ(header(kAmbientOcclusion).integrator.bsdf_sampling, DIRECTION_COSINE);
  EXPECT_EQ(header(kReflectionOcclusion).integrator.bsdf_sampling, DIRECTION_LOBE);
  EXPECT_EQ(header(kReflectionOcclusion).integrator.exponent, 30);
  EXPECT_EQ(header(kAmbientOcclusion,
                   [](S& s) {
                     param::sampling(s.integrator) = OcclusionSampling::kSphere;
                     param::weighting(s.integrator) = OcclusionWeighting::kUniform;
                   })
                .integrator.bsdf_sampling,
            DIRECTION_SPHERE);
}

// --- what is not there

TEST(IntegratorBuilder, WithoutPolygonLightsNothingOfThemIsLeft) {
  const Change no_lights = [](S& scene) { scene.shapes.resize(1); };
  const Change only_a_sphere = all({no_lights, with_sphere});
  const Change black = [](S& scene) { scene.shapes[1].radiance = glm::vec3(0); };
  const Change without_area = [](S& scene) {
    for (dvec3& p : std::get<Mesh>(scene.shapes[1].geometry).positions) p = dvec3(p.x, 1, 0);
  };
  const std::pair<const char*, Change> changes[] = {{"no lights", no_lights},
                                                    {"only a sphere", only_a_sphere},
                                                    {"a black one", black},
                                                    {"one without area", without_area}};
  for (const auto& [what, change] : changes)
    for (const Change& more : {Change([](S&) {}), Change(by_contribution), with_alpha(0.5f)})
      for (const IntegratorKind kind : {kPolygonAnalytic, kPolygonArea, kPolygonCv}) {
        const SceneHeader h = header(kind, all({change, where_there(more)}));
        EXPECT_EQ(h.integrator.estimator, ESTIMATOR_SAMPLES) << what;
        EXPECT_EQ(h.integrator.light_choice, CHOICE_POWER) << what;
        EXPECT_EQ(h.tables.polygons.count + h.tables.polygon_corners.count, 0) << what;
        EXPECT_EQ(h.features & (FEATURE_POLYGONS | FEATURE_PROJECTED | FEATURE_SOLID_ANGLE), 0u) << what;
      }
}

TEST(IntegratorBuilder, WithoutAreaEveryTriangleIsCountedAsDropped) {
  const SceneHeader h = header(kPolygonCv, [](S& scene) {
    for (dvec3& p : std::get<Mesh>(scene.shapes[1].geometry).positions) p = dvec3(p.x, 1, 0);
  });
  EXPECT_EQ(h.dropped_triangles, 2);
  EXPECT_EQ(h.tables.triangles.count, 2);
  EXPECT_EQ(h.tables.lights.count, 0);
}

TEST(IntegratorBuilder, DuplicatesAreSaidHoweverLightsAreSampled) {
  const Change repeated = [](S& scene) {
    Mesh& mesh = std::get<Mesh>(scene.shapes[1].geometry);
    mesh.triangles.push_back(mesh.triangles[0]);
  };
  for (const IntegratorKind kind : {kDirect, kPath, kPolygonAnalytic, kPolygonArea, kPolygonCv}) {
    EXPECT_EQ(header(kind).duplicate_lights, 0);
    const SceneHeader h = header(kind, repeated);
    EXPECT_EQ(h.duplicate_lights, 1);
    EXPECT_EQ(h.tables.triangles.count, 5);
    EXPECT_EQ(h.tables.lights.count, 1) << "one rectangle";
  }
}

TEST(IntegratorBuilder, LayersAreAFeatureOfTheirOwn) {
  for (const IntegratorKind kind : {kDirect, kPath, kPolygonAnalytic, kPolygonArea, kPolygonCv}) {
    const std::uint64_t with = header(kind).features, without = header(kind, {}, false).features;
    EXPECT_EQ(with, without | FEATURE_LAYERS);
    EXPECT_EQ(without & FEATURE_LAYERS, 0u);
  }
}

// --- contradictions

TEST(IntegratorBuilder, AChoiceByContributionNeedsEmitterSamplesAlone) {
  const std::pair<IntegratorKind, Change> wrong[] = {{kDirect, by_contribution},
                                                     {kPath, by_contribution},
                                                     {kPath, all({mats, by_contribution})},
                                                     {kPath, all({with_cv, with_sphere, by_contribution})}};
  for (const auto& [kind, change] : wrong) {
    S scene = under_a_square(kind);
    change(scene);
    const auto built = try_build(scene, true);
    ASSERT_FALSE(built);
    EXPECT_THAT(
        built.error().message,
        AllOf(HasSubstr("some-scene.xml: "), HasSubstr("light_choice = analytic"),
              HasSubstr("bsdf_samples = 0"), HasSubstr("direct_sampling = ems"), HasSubstr("polygon_cv")));
  }
  // What the message proposes is right.
  for (const auto& [kind, change] : {std::pair<IntegratorKind, Change>{kDirect, no_bsdf_samples},
                                     {kPath, ems},
                                     {kPolygonArea, {}},
                                     {kPolygonCv, {}},
                                     {kPath, with_cv}}) {
    EXPECT_EQ(header(kind, change ? all({change, by_contribution}) : by_contribution).integrator.light_choice,
              CHOICE_ANALYTIC);
  }
}

TEST(IntegratorBuilder, HelpersSayWhatIsWanted) {
  const auto settings = [](IntegratorKind kind) {
    IntegratorSettings result;
    use(result, kind);
    return result;
  };
  EXPECT_FALSE(wants_polygons(settings(kDirect)));
  EXPECT_FALSE(wants_polygons(settings(kPath)));
  EXPECT_FALSE(wants_polygons(settings(kPolygonArea)));
  EXPECT_TRUE(wants_polygons(settings(kPolygonAnalytic)));
  EXPECT_TRUE(wants_polygons(settings(kPolygonCv)));
  IntegratorSettings path = settings(kPath);
  param::next_event(path) = NextEvent::kCv;
  EXPECT_TRUE(wants_polygons(path));
  IntegratorSettings direct = settings(kDirect);
  param::light_choice(direct) = LightChoice::kAnalytic;
  EXPECT_TRUE(wants_polygons(direct));

  EXPECT_EQ(default_sampling(settings(kDirect)), EmitterSampling::kAuto);
  EXPECT_EQ(default_sampling(settings(kPolygonArea)), EmitterSampling::kArea);
  EXPECT_EQ(default_sampling(settings(kPolygonCv)), EmitterSampling::kSolidAngle);
  EXPECT_EQ(default_sampling(settings(kPolygonCv), true), EmitterSampling::kProjected);
  EXPECT_EQ(default_sampling(path), EmitterSampling::kSolidAngle);
  param::emitter_sampling(path) = EmitterSampling::kProjected;
  EXPECT_EQ(default_sampling(path), EmitterSampling::kProjected);
}

}  // namespace
}  // namespace penumbra
