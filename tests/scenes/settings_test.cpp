#include "scenes/settings.h"
#include "tests/support/integrator_parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string error(std::string_view key, std::string_view value) {
  SceneDescription scene;
  const auto done = apply_setting(scene, key, value);
  EXPECT_FALSE(done) << key << " = " << value;
  return done ? "" : done.error().message;
}

TEST(Settings, SetEveryGroup) {
  SceneDescription scene;
  const std::pair<const char*, const char*> values[] = {{"integrator.type", "direct"},
                                                        {"integrator.emitterSamples", "4"},
                                                        {"integrator.bsdf_samples", "0"},
                                                        {"integrator.bsdf_sampling", "uniform"},
                                                        {"integrator.emitter_sampling", "solid_angle"},
                                                        {"integrator.mis", "power"},
                                                        {"integrator.hide_emitters", "true"},
                                                        {"sampler.type", "halton"},
                                                        {"sampler.sample_count", "2147483648"},
                                                        {"sampler.seed", "4294967295"},
                                                        {"film.width", "65536"},
                                                        {"film.height", "1"},
                                                        {"film.rfilter", "mitchell"},
                                                        {"film.rfilter_b", "0.5"},
                                                        {"camera.fov", "1e-6"},
                                                        {"camera.fovAxis", "diagonal"},
                                                        {"camera.near_clip", "0.5"}};
  for (const auto& [key, value] : values) {
    const auto done = apply_setting(scene, key, value);
    ASSERT_TRUE(done) << done.error().message;
  }
  EXPECT_EQ(kind_of(scene.integrator), IntegratorKind::kDirect);
  EXPECT_EQ(param::emitter_samples(scene.integrator), 4);
  EXPECT_EQ(param::bsdf_samples(scene.integrator), 0);
  EXPECT_EQ(param::bsdf_sampling(scene.integrator), BsdfSampling::kUniform);
  EXPECT_EQ(param::emitter_sampling(scene.integrator), EmitterSampling::kSolidAngle);
  ASSERT_TRUE(apply_setting(scene, "integrator.emitter_sampling", "projected"));
  EXPECT_EQ(param::emitter_sampling(scene.integrator), EmitterSampling::kProjected);
  EXPECT_EQ(param::heuristic(scene.integrator), MisHeuristic::kPower);
  EXPECT_TRUE(scene.integrator.hide_emitters);
  EXPECT_EQ(scene.sampler.kind, SamplerKind::kHalton);
  EXPECT_EQ(scene.sampler.spp, 2147483648u);
  EXPECT_EQ(scene.sampler.seed, 4294967295u);
  EXPECT_EQ(scene.film.crop_width, 65536);
  EXPECT_EQ(scene.film.crop_height, 1);
  EXPECT_EQ(scene.film.filter, FilterKind::kMitchell);
  EXPECT_EQ(scene.film.filter_radius, 2.0f);
  EXPECT_EQ(scene.film.filter_b, 0.5f);
  EXPECT_EQ(scene.camera.fov, 1e-6);
  EXPECT_EQ(scene.camera.fov_axis, FovAxis::kDiagonal);
  EXPECT_TRUE(check_settings(scene));
}

TEST(Settings, TheShutter) {
  SceneDescription scene;
  EXPECT_EQ(print_setting(scene, "camera.shutter"), "auto");
  EXPECT_EQ(print_setting(scene, "camera.shutter_position"), "start");
  EXPECT_EQ(print_setting(scene, "camera.shutter_curve"), "box");
  EXPECT_EQ(print_setting(scene, "camera.rolling_shutter"), "0");
  const auto set = [&](const char* key, const char* value) {
    const auto done = apply_setting(scene, key, value);
    EXPECT_TRUE(done) << done.error().message;
    return print_setting(scene, key);
  };
  EXPECT_EQ(set("camera.shutter", "10"), "10");
  EXPECT_EQ(set("camera.shutter", "auto"), "auto");
  EXPECT_EQ(set("camera.shutter_position", "centre"), "center");
  EXPECT_EQ(set("camera.shutter_curve", "triangle"), "triangle");
  EXPECT_EQ(scene.camera.shutter_curve, (std::vector{0.0, 1.0, 0.0}));
  EXPECT_EQ(set("camera.shutter_curve", "0 1, 0.5 0"), "0,1,0.5,0");
  EXPECT_EQ(set("camera.shutter_curve", print_setting(scene, "camera.shutter_curve").c_str()), "0,1,0.5,0");
  EXPECT_EQ(set("camera.shutter_curve", "1 1"), "box");
  EXPECT_THAT(error("camera.shutter", "-0.1"), HasSubstr("not between 0 and 10"));
  EXPECT_THAT(error("camera.shutter", "10.5"), HasSubstr("not between 0 and 10"));
  EXPECT_THAT(error("camera.shutter_position", "middle"), HasSubstr("start, center"));
  EXPECT_THAT(error("camera.shutter_curve", "tringle"), HasSubstr("box, triangle"));
  EXPECT_THAT(error("camera.shutter_curve", "1"), HasSubstr("2 to 256 numbers, not 1"));
  EXPECT_THAT(error("camera.shutter_curve", "0 0"), HasSubstr("above 0"));
  EXPECT_THAT(error("camera.shutter_curve", "1 -0.5 1"), HasSubstr("-0.5 is below 0"));
  EXPECT_THAT(error("camera.shutter_curve", "1 inf"), HasSubstr("box, triangle"));
  EXPECT_THAT(error("camera.rolling_shutter", "-1"), HasSubstr("at least 0 and below 10"));
}

TEST(Settings, PathPresets) {
  SceneDescription scene;
  ASSERT_TRUE(apply_setting(scene, "integrator.type", "path_mats"));
  EXPECT_EQ(kind_of(scene.integrator), IntegratorKind::kPath);
  EXPECT_EQ(param::direct_sampling(scene.integrator), DirectSampling::kBsdfOnly);
  ASSERT_TRUE(apply_setting(scene, "integrator.type", "path_ems"));
  EXPECT_EQ(param::direct_sampling(scene.integrator), DirectSampling::kEmitterOnly);
  ASSERT_TRUE(apply_setting(scene, "integrator.direct_sampling", "mis"));
  EXPECT_EQ(param::direct_sampling(scene.integrator), DirectSampling::kMis);
}

TEST(Settings, PolygonLights) {
  const std::pair<const char*, IntegratorKind> kinds[] = {
      {"polygon_analytic", IntegratorKind::kPolygonAnalytic},
      {"polygon_area", IntegratorKind::kPolygonArea},
      {"polygon_cv", IntegratorKind::kPolygonCv}};
  SceneDescription scene;
  const IntegratorSettings& settings = scene.integrator;
  const auto set = [&](std::string_view key, std::string_view value) {
    const auto done = apply_setting(scene, key, value);
    EXPECT_TRUE(done) << done.error().message;
  };
  for (const auto& [name, kind] : kinds) {
    set("integrator.type", name);
    EXPECT_EQ(kind_of(settings), kind);
    EXPECT_TRUE(check_settings(scene));
  }
  for (const auto& [text, alpha] : {std::pair<const char*, std::optional<float>>{"0.5", 0.5f},
                                    {"auto", std::nullopt},
                                    {"-1e6", -1e6f},
                                    {" auto ", std::nullopt}}) {
    set("integrator.alpha", text);
    EXPECT_EQ(param::alpha(settings), alpha) << text;
  }
  set("integrator.type", "path");
  set("integrator.nee", "cv");
  EXPECT_EQ(param::next_event(settings), NextEvent::kCv);
  set("integrator.nee", "sample");
  EXPECT_EQ(param::next_event(settings), NextEvent::kSample);
  for (const auto& [text, choice] : {std::pair{"power", LightChoice::kPower},
                                     {"analytic", LightChoice::kAnalytic},
                                     {"auto", LightChoice::kAuto}}) {
    set("integrator.lightChoice", text);
    EXPECT_EQ(param::light_choice(settings), choice);
  }
  set("integrator.type", "polygon_area");
  set("integrator.traceShadows", "false");
  EXPECT_FALSE(param::trace_shadows(settings));
  set("integrator.type", "polygon_cv");
  set("integrator.visSamples", "65536");
  EXPECT_EQ(param::vis_samples(settings), 65536);
}

TEST(Settings, ErrorsOfPolygonLightsSayWhatWouldBeRight) {
  EXPECT_THAT(error("integrator.alpha", "x"),
              AllOf(HasSubstr("setting integrator.alpha: "), HasSubstr("nor is it 'auto'")));
  EXPECT_THAT(error("integrator.alpha", "nan"), HasSubstr("nor is it 'auto'"));
  EXPECT_THAT(error("integrator.alpha", "-1000001"), HasSubstr("not between -1000000 and 1000000"));
  EXPECT_THAT(error("integrator.light_choice", "all"),
              HasSubstr("'all' is not one of: auto, power, analytic, tree"));
  EXPECT_THAT(error("integrator.nee", "none"), HasSubstr("'none' is not one of: sample, cv"));
  EXPECT_THAT(error("integrator.trace_shadows", "no"), HasSubstr("neither true nor false"));
  EXPECT_THAT(error("film.layers", "uv,normal"), HasSubstr("'normal' is not one of: position, uv"));
  EXPECT_THAT(error("film.layers", "uv,,shape"), HasSubstr("comma"));
  EXPECT_THAT(error("film.layers", ""), HasSubstr("'none' stands for none"));
  EXPECT_THAT(error("integrator.vis_samples", "0"), HasSubstr("from 1 to 65536"));
  EXPECT_THAT(error("integrator.vis_samples", "1.5"), HasSubstr("not an integer"));
  EXPECT_THAT(error("integrator.type", "polygon"), HasSubstr("polygon_analytic, polygon_area, polygon_cv"));

  SceneDescription scene;
  use(scene.integrator, IntegratorKind::kPolygonArea);
  param::emitter_samples(scene.integrator) = 0;
  EXPECT_THAT(check_settings(scene).error().message, HasSubstr("'polygon_area' needs emitter_samples"));
  use(scene.integrator, IntegratorKind::kPolygonCv);
  EXPECT_TRUE(check_settings(scene)) << "it has vis_samples";
  use(scene.integrator, IntegratorKind::kPath);
  param::next_event(scene.integrator) = NextEvent::kCv;
  EXPECT_TRUE(check_settings(scene));
  param::direct_sampling(scene.integrator) = DirectSampling::kBsdfOnly;
  EXPECT_THAT(check_settings(scene).error().message, HasSubstr("which direct_sampling = mats forbids"));
  use(scene.integrator, IntegratorKind::kWhitted);
  EXPECT_TRUE(check_settings(scene));
  param::indirect_samples(scene.integrator) = 64;
  EXPECT_THAT(check_settings(scene).error().message, HasSubstr("branch 64 times at each of 4 surfaces"));
  param::max_depth(scene.integrator) = 3;
  EXPECT_TRUE(check_settings(scene));
  use(scene.integrator, IntegratorKind::kAmbientOcclusion);
  EXPECT_TRUE(check_settings(scene));
  param::weighting(scene.integrator) = OcclusionWeighting::kUniform;
  EXPECT_THAT(check_settings(scene).error().message, HasSubstr("no finite variance"));
  param::sampling(scene.integrator) = OcclusionSampling::kSphere;
  EXPECT_TRUE(check_settings(scene));
}

TEST(Settings, PhotonMaps) {
  SceneDescription scene;
  const auto set = [&](std::string_view key, std::string_view value) {
    const auto done = apply_setting(scene, key, value);
    EXPECT_TRUE(done) << done.error().message;
  };
  set("integrator.max_depth", "7");
  set("integrator.type", "photonmapper");
  for (const auto& [key, value] : {std::pair{"integrator.globalPhotons", "1000"},
                                   {"integrator.caustic_photons", "0"},
                                   {"integrator.volume_photons", "16777216"},
                                   {"integrator.global_lookup_radius", "0.5"},
                                   {"integrator.photon_radius", "0.25"},
                                   {"integrator.lookup_size", "1"},
                                   {"integrator.final_gather", "true"}})
    set(key, value);
  const auto& maps = *scene.integrator.get<PhotonMapIntegrator>();
  EXPECT_EQ(maps.max_depth, 7);
  EXPECT_EQ(maps.global_photons, 1000);
  EXPECT_EQ(maps.caustic_photons, 0);
  EXPECT_EQ(maps.volume_photons, MAX_PHOTONS);
  EXPECT_EQ(maps.global_lookup_radius, 0.5f);
  EXPECT_EQ(maps.photon_radius, 0.25f);
  EXPECT_EQ(maps.lookup_size, 1);
  EXPECT_TRUE(maps.final_gather);
  EXPECT_TRUE(check_settings(scene));
  for (const char* name : {"ppm", "pppm", "sppm"}) {
    set("integrator.type", name);
    EXPECT_TRUE(scene.integrator.is<ProgressivePhotonIntegrator>());
    EXPECT_EQ(print_setting(scene, "integrator.type"), "ppm");
  }
  set("integrator.initial_radius", "0.5");
  set("integrator.photon_count", "1");
  EXPECT_TRUE(check_settings(scene));
}

TEST(Settings, AlphaOfRadiiIsNotThatOfControlVariates) {
  SceneDescription scene;
  const auto set = [&](std::string_view key, std::string_view value) {
    const auto done = apply_setting(scene, key, value);
    EXPECT_TRUE(done) << done.error().message;
  };
  set("integrator.alpha", "-5");
  set("integrator.type", "ppm");
  EXPECT_EQ(param::alpha(scene.integrator), 0.7f);
  set("integrator.alpha", "0.5");
  set("integrator.type", "sppm");
  EXPECT_EQ(param::alpha(scene.integrator), 0.5f) << "the same integrator";
  set("integrator.type", "volpath");
  EXPECT_EQ(param::alpha(scene.integrator), std::nullopt);
}

TEST(Settings, ErrorsOfPhotonMapsSayWhatWouldBeRight) {
  for (const char* key :
       {"integrator.global_photons", "integrator.caustic_photons", "integrator.volume_photons"})
    for (const char* value : {"-1", "1000000000"})
      EXPECT_THAT(error(key, value), AllOf(HasSubstr(key), HasSubstr("from 0 to 16777216")));
  for (const char* value : {"0", "1000000000"})
    EXPECT_THAT(error("integrator.photon_count", value),
                AllOf(HasSubstr("integrator.photon_count"), HasSubstr("from 1 to 16777216")));
  for (const char* key : {"integrator.initial_radius", "integrator.photon_radius"})
    EXPECT_THAT(error(key, "-0.5"), AllOf(HasSubstr(key), HasSubstr("at least 0")));
  for (const char* key : {"integrator.global_lookup_radius", "integrator.caustic_lookup_radius",
                          "integrator.volume_lookup_radius"})
    for (const char* value : {"0", "-1", "1"})
      EXPECT_THAT(error(key, value), AllOf(HasSubstr(key), HasSubstr("above 0 and below 1")));
  EXPECT_THAT(error("integrator.lookup_size", "0"), HasSubstr("from 1 to 16777216"));
  EXPECT_THAT(error("integrator.final_gather", "2"), HasSubstr("neither true nor false"));

  SceneDescription scene;
  scene.integrator.method =
      PhotonMapIntegrator{.global_photons = 0, .caustic_photons = 0, .volume_photons = 0};
  EXPECT_THAT(check_settings(scene).error().message,
              AllOf(HasSubstr("'photonmapper' needs photons"), HasSubstr("global_photons"),
                    HasSubstr("caustic_photons"), HasSubstr("volume_photons"), HasSubstr("above 0")));
  scene.integrator.method =
      PhotonMapIntegrator{.global_photons = 0, .caustic_photons = 0, .volume_photons = 1};
  EXPECT_TRUE(check_settings(scene));
  for (const float alpha : {0.0f, -0.5f, 1.5f}) {
    scene.integrator.method = ProgressivePhotonIntegrator{.alpha = alpha};
    const auto checked = check_settings(scene);
    ASSERT_FALSE(checked) << alpha;
    EXPECT_THAT(checked.error().message,
                AllOf(HasSubstr("'ppm' with alpha = "), HasSubstr("above 0 and up to 1")));
  }
  for (const std::optional<float> alpha :
       {std::optional(0.001f), std::optional(1.0f), std::optional<float>()}) {
    scene.integrator.method = ProgressivePhotonIntegrator{.alpha = alpha};
    EXPECT_TRUE(check_settings(scene));
  }
}

TEST(Settings, ACropWindowFollowsTheFilmOnlyIfItWasAllOfIt) {
  SceneDescription scene;
  ASSERT_TRUE(apply_setting(scene, "film.width", "100"));
  EXPECT_EQ(scene.film.crop_width, 100);
  ASSERT_TRUE(apply_setting(scene, "film.crop_width", "50"));
  ASSERT_TRUE(apply_setting(scene, "film.width", "200"));
  EXPECT_EQ(scene.film.crop_width, 50);
}

TEST(Settings, TheGaussiansRadiusFollowsItsWidth) {
  SceneDescription scene;
  ASSERT_TRUE(apply_setting(scene, "film.rfilter_stddev", "0.75"));
  EXPECT_EQ(scene.film.filter_radius, 3.0f);
}

TEST(Settings, CameraFrames) {
  SceneDescription scene;
  ASSERT_TRUE(apply_setting(scene, "camera.lookat", "1,2,3, 1,2,9, 0,1,0"));
  EXPECT_EQ(glm::dvec3(scene.camera.to_world[2]), glm::dvec3(0, 0, 1));
  EXPECT_EQ(glm::dvec3(scene.camera.to_world[3]), glm::dvec3(1, 2, 3));
  ASSERT_TRUE(apply_setting(scene, "camera.to_world", "2 0 0 5  0 2 0 6  0 0 2 7  0 0 0 1"));
  EXPECT_EQ(glm::dvec3(scene.camera.to_world[0]), glm::dvec3(1, 0, 0));
  EXPECT_EQ(glm::dvec3(scene.camera.to_world[3]), glm::dvec3(5, 6, 7));
  EXPECT_THAT(error("camera.lookat", "1,2,3"), HasSubstr("9 numbers, not 3"));
  EXPECT_THAT(error("camera.to_world", "1 0 0 0 0 1 0 0 0 0 0 0 0 0 0 1"), HasSubstr("singular"));
}

TEST(Settings, ErrorsSayWhatWouldBeRight) {
  EXPECT_THAT(error("integrator.max_dept", "3"),
              AllOf(HasSubstr("no setting 'integrator.max_dept'"),
                    HasSubstr("did you mean 'integrator.max_depth'? `penumbra settings` lists all")));
  EXPECT_THAT(error("something", "3"), HasSubstr("the settings are: integrator.type, "));
  EXPECT_THAT(error("max_depth", "3"), HasSubstr("'max_depth'; did you mean 'integrator.max_depth'?"));
  EXPECT_THAT(error("sampler.sample_count", "0"),
              HasSubstr("setting sampler.sample_count: '0' is not in the range from 1 to 2147483648"));
  EXPECT_THAT(error("film.width", "65537"), HasSubstr("from 1 to 65536"));
  EXPECT_THAT(error("integrator.type", "pth"),
              AllOf(HasSubstr("did you mean 'path'?"), HasSubstr("direct, path")));
  EXPECT_THAT(error("integrator.max_depth", "-2"), HasSubstr("from -1"));
  EXPECT_THAT(error("camera.fov", "180"), HasSubstr("above 0 and below 180"));
  EXPECT_THAT(error("camera.fov", "0"), HasSubstr("above 0 and below 180"));
  EXPECT_THAT(error("camera.fov", "nan"), HasSubstr("finite"));
  EXPECT_THAT(error("film.rfilter_stddev", "0"), HasSubstr("at least 0.0001"));
  EXPECT_THAT(error("integrator.hide_emitters", "1"), HasSubstr("neither true nor false"));
  EXPECT_THAT(error("", ""), HasSubstr("no setting ''"));
}

TEST(Settings, WhatNoSingleSettingCanTell) {
  SceneDescription scene;
  EXPECT_TRUE(check_settings(scene));
  scene.film.crop_x = 1;
  EXPECT_THAT(check_settings(scene).error().message, HasSubstr("crop window of 768 x 576 pixels at (1, 0)"));
  scene.film = {.width = 65536, .height = 65536, .crop_width = 65536, .crop_height = 65536};
  EXPECT_THAT(check_settings(scene).error().message, HasSubstr("too large"));
  scene.film = {.width = 65536, .height = 65536, .crop_x = 65000, .crop_width = 500, .crop_height = 65536};
  EXPECT_TRUE(check_settings(scene));
  scene.integrator = {.method = DirectIntegrator{.emitter_samples = 0, .bsdf_samples = 0}};
  EXPECT_THAT(check_settings(scene).error().message, HasSubstr("at least one of"));
  scene.integrator = {};
  scene.camera.far_clip = scene.camera.near_clip;
  EXPECT_THAT(check_settings(scene).error().message, HasSubstr("near_clip"));
}

TEST(Settings, ParametersOfOtherIntegratorsAreErrors) {
  SceneDescription scene;
  ASSERT_TRUE(apply_setting(scene, "integrator.type", "direct"));
  const auto done = apply_setting(scene, "integrator.alpha", "1");
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().message,
            "setting integrator.alpha: integrator 'direct' has no parameter 'alpha'; these have: path, "
            "polygon_cv, whitted, volpath, ppm");
  EXPECT_THAT(error("integrator.shading_samples", "1"), HasSubstr("these have: direct, ao"));
  // What is wrong with the value comes first.
  EXPECT_THAT(error("integrator.trace_shadows", "0"), HasSubstr("neither true nor false"));
}

TEST(Settings, AnotherIntegratorKeepsWhatBothHave) {
  SceneDescription scene;
  const auto set = [&](std::string_view key, std::string_view value) {
    const auto done = apply_setting(scene, key, value);
    EXPECT_TRUE(done) << done.error().message;
  };
  const std::pair<const char*, const char*> shared[] = {{"integrator.emitter_sampling", "area"},
                                                        {"integrator.mis", "power"},
                                                        {"integrator.light_choice", "power"},
                                                        {"integrator.hide_emitters", "true"},
                                                        {"integrator.hidden_emitters", "looked_through"}};
  set("integrator.type", "path_ems");
  for (const auto& [key, value] : shared) set(key, value);
  set("integrator.type", "direct");
  for (const auto& [key, value] : shared) EXPECT_EQ(print_setting(scene, key), value) << key;
  set("integrator.type", "path");
  EXPECT_EQ(print_setting(scene, "integrator.type"), "path_mis") << "the name says how it samples";
  for (const auto& [key, value] : shared) EXPECT_EQ(print_setting(scene, key), value) << key;
}

TEST(Settings, KeysAreUnique) {
  std::set<std::string> keys;
  for (const Setting& each : all_settings()) EXPECT_TRUE(keys.insert(each.key).second) << each.key;
}

TEST(Settings, TheirTextsSayWhichLimitsAreAllowed) {
  const auto setting = [](std::string_view key) {
    return *std::ranges::find(all_settings(), key, &Setting::key);
  };
  EXPECT_EQ(setting("camera.aperture_radius").values, "0 or more");
  EXPECT_EQ(setting("camera.focus_distance").values, "above 0");
  EXPECT_EQ(setting("camera.fov").values, "above 0 and below 180");
}

}  // namespace
}  // namespace penumbra
