// [renderer] of TinyRender scenes: conversion of every type and method.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scenes/tinyrender_text.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class TinyRenderRenderer : public TinyRenderText {
 protected:
  IntegratorSettings integrator(std::string_view renderer) {
    const SceneDescription scene = good_toml(scene_with(renderer));
    EXPECT_THAT(scene.warnings, IsEmpty()) << renderer;
    return scene.integrator;
  }

  void expect_direct(std::string_view strategy, int emitter_samples, int bsdf_samples,
                     EmitterSampling emitter_sampling, BsdfSampling bsdf_sampling = BsdfSampling::kBsdf) {
    SCOPED_TRACE(strategy);
    const IntegratorSettings s =
        integrator("type = \"direct\"\nsamplingStrategy = \"" + std::string(strategy) + "\"");
    EXPECT_EQ(kind_of(s), IntegratorKind::kDirect);
    EXPECT_EQ(param::emitter_samples(s), emitter_samples);
    EXPECT_EQ(param::bsdf_samples(s), bsdf_samples);
    EXPECT_EQ(param::emitter_sampling(s), emitter_sampling);
    EXPECT_EQ(param::bsdf_sampling(s), bsdf_sampling);
    EXPECT_EQ(param::heuristic(s), MisHeuristic::kBalance);
    EXPECT_TRUE(param::trace_shadows(s));
  }
};

TEST_F(TinyRenderRenderer, DirectStrategies) {
  using enum EmitterSampling;
  expect_direct("mis", 1, 1, kArea);
  expect_direct("emitter", 1, 0, kArea);
  expect_direct("area", 1, 0, kArea);
  expect_direct("solidAngle", 1, 0, kSolidAngle);
  expect_direct("bsdf", 0, 1, kArea);
  expect_direct("cosineHemisphere", 0, 1, kArea, BsdfSampling::kCosine);
  expect_direct("cosine", 0, 1, kArea, BsdfSampling::kCosine);
  expect_direct("uniformHemisphere", 0, 1, kArea, BsdfSampling::kUniform);
  expect_direct("uniform", 0, 1, kArea, BsdfSampling::kUniform);
  for (const char* spelling : {"SolidAngle", "solid_angle", "SOLID-ANGLE", "solid angle"})
    expect_direct(spelling, 1, 0, kSolidAngle);
  const IntegratorSettings by_default = integrator(kDirect);
  EXPECT_EQ(param::emitter_samples(by_default), 1);
  EXPECT_EQ(param::bsdf_samples(by_default), 1);
}

TEST_F(TinyRenderRenderer, DirectCounts) {
  const IntegratorSettings both = integrator("type = \"direct\"\nemitterSamples = 64\nbsdfSamples = 32");
  EXPECT_EQ(param::emitter_samples(both), 64);
  EXPECT_EQ(param::bsdf_samples(both), 32);
  EXPECT_EQ(param::emitter_samples(integrator("type = \"direct\"\nemitterSamples = 0\nbsdfSamples = 64")), 0);
  EXPECT_EQ(param::bsdf_samples(integrator("type = \"direct\"\nemitterSamples = 64\nbsdfSamples = 0")), 0);
  EXPECT_THAT(toml_error(scene_with("type = \"direct\"\nemitterSamples = 0\nbsdfSamples = 0")),
              HasSubstr("needs at least one of emitter_samples and bsdf_samples"));
  EXPECT_THAT(
      toml_error(scene_with("type = \"direct\"\nemitterSamples = -1")),
      HasSubstr("scene.toml:12:18: error: [renderer] emitterSamples: '-1' is not in the range from 0"));
  EXPECT_THAT(
      toml_error(scene_with("type = \"direct\"\nemitterSamples = 1.5")),
      HasSubstr("scene.toml:12:18: error: [renderer] emitterSamples must be an integer, not a number"));
  const SceneDescription unused =
      good_toml(scene_with("type = \"direct\"\nsamplingStrategy = \"emitter\"\nbsdfSamples = 4"));
  EXPECT_EQ(param::bsdf_samples(unused.integrator), 0);
  EXPECT_EQ(warnings(unused),
            "scene.toml:13:15: warning: bsdfSamples has no effect with samplingStrategy = emitter\n");
}

TEST_F(TinyRenderRenderer, PolygonalMethods) {
  EXPECT_EQ(kind_of(integrator("type = \"polygonal\"\nmethod = \"analytic\"")),
            IntegratorKind::kPolygonAnalytic);
  for (const char* text : {"type = \"polygonal\"\nmethod = \"area\"", "type = \"polygonal\"",
                           "type = \"polygonal\"\nrealtime = false\ntraceShadows = false"}) {
    const IntegratorSettings area = integrator(text);
    EXPECT_EQ(kind_of(area), IntegratorKind::kPolygonArea) << text;
    EXPECT_EQ(param::emitter_samples(area), 1);
    EXPECT_FALSE(param::trace_shadows(area));
  }
  EXPECT_TRUE(
      param::trace_shadows(integrator("type = \"polygonal\"\nmethod = \"area\"\ntraceShadows = true")));
  for (const char* method : {"controlVariates", "control_variates", "ControlVariates"}) {
    const IntegratorSettings cv = integrator("type = \"polygonal\"\nmethod = \"" + std::string(method) +
                                             "\"\nalpha = 0.75\nvisSamples = 4\nbonus = true");
    EXPECT_EQ(kind_of(cv), IntegratorKind::kPolygonCv);
    EXPECT_EQ(param::alpha(cv), 0.75f);
    EXPECT_EQ(param::vis_samples(cv), 4);
    EXPECT_EQ(param::emitter_sampling(cv), EmitterSampling::kArea);
  }
  const IntegratorSettings by_default = integrator("type = \"polygonal\"\nmethod = \"controlVariates\"");
  EXPECT_EQ(param::alpha(by_default), 1.0f);
  EXPECT_EQ(param::vis_samples(by_default), 1);
  EXPECT_EQ(param::alpha(integrator("type = \"polygonal\"\nmethod = \"controlVariates\"\nalpha = 1")), 1.0f);
  EXPECT_EQ(param::alpha(integrator("type = \"polygonal\"\nmethod = \"controlVariates\"\nalpha = \"auto\"")),
            std::nullopt);
}

TEST_F(TinyRenderRenderer, TheWindowsPicture) {
  EXPECT_EQ(kind_of(integrator("type = \"polygonal\"\nrealtime = true")), IntegratorKind::kPolygonAnalytic);
  EXPECT_EQ(kind_of(integrator("type = \"polygonal\"\nrealtime = true\ntest = false")),
            IntegratorKind::kPolygonAnalytic);
  const IntegratorSettings hybrid = integrator("type = \"polygonal\"\nrealtime = true\ntest = true");
  EXPECT_EQ(kind_of(hybrid), IntegratorKind::kPolygonCv);
  EXPECT_EQ(param::alpha(hybrid), 1.0f);
  EXPECT_EQ(kind_of(integrator("type = \"polygonal\"\nrealtime = true\ntest = true\nmethod = \"area\"")),
            IntegratorKind::kPolygonArea);
  EXPECT_EQ(kind_of(integrator("type = \"polygonal\"\nrealtime = true\nmethod = \"controlVariates\"")),
            IntegratorKind::kPolygonCv);
  const SceneDescription other = good_toml(scene_with("type = \"direct\"\nrealtime = true"));
  EXPECT_EQ(warnings(other),
            "scene.toml:12:12: warning: what the window shows for type = direct is not read; it "
            "is rendered offline\n");
}

TEST_F(TinyRenderRenderer, PathDepthIsInEdges) {
  EXPECT_EQ(kind_of(integrator("type = \"path\"")), IntegratorKind::kPath);
  EXPECT_EQ(param::max_depth(integrator("type = \"path\"")), -1);
  EXPECT_EQ(param::max_depth(integrator("type = \"path\"\nmaxDepth = -1")), -1);
  EXPECT_EQ(param::max_depth(integrator("type = \"path\"\nmaxDepth = 0")), 1) << "emitters only";
  EXPECT_EQ(param::max_depth(integrator("type = \"path\"\nmaxDepth = 4\nrrDepth = 3\nrrProb = 0.9")), 5);
  EXPECT_EQ(param::rr_depth(integrator("type = \"path\"\nmaxDepth = 4\nrrDepth = 3")), 4);
  EXPECT_EQ(param::direct_sampling(integrator("type = \"path\"\nisExplicit = true")), DirectSampling::kMis);
  EXPECT_EQ(param::direct_sampling(integrator("type = \"path\"\nisExplicit = false")),
            DirectSampling::kBsdfOnly);
  EXPECT_THAT(toml_error(scene_with("type = \"path\"\nmaxDepth = -2")),
              HasSubstr("scene.toml:12:12: error: -2 is not in the range from -1 to 2147483646"));
  EXPECT_THAT(toml_error(scene_with("type = \"path\"\nmaxDepth = 2147483647")),
              HasSubstr("not in the range"));
}

TEST_F(TinyRenderRenderer, AmbientOcclusion) {
  const IntegratorSettings ambient = integrator("type = \"ao\"");
  EXPECT_EQ(kind_of(ambient), IntegratorKind::kAmbientOcclusion);
  EXPECT_EQ(param::sampling(ambient), OcclusionSampling::kCosine);
  EXPECT_EQ(param::weighting(ambient), OcclusionWeighting::kCosine);
  EXPECT_LT(param::ray_length(ambient), 0) << "half the scene's radius";
  EXPECT_EQ(param::background(ambient), 0);
  EXPECT_EQ(param::vis_samples(ambient), 1);
  const auto sampling = [&](const std::string& name) {
    return param::sampling(integrator("type = \"ao\"\nsampling_type = \"" + name + "\""));
  };
  EXPECT_EQ(sampling("cosine"), OcclusionSampling::kCosine);
  EXPECT_EQ(sampling("hemisphere"), OcclusionSampling::kHemisphere);
  EXPECT_EQ(sampling("sphere"), OcclusionSampling::kSphere);
  EXPECT_THAT(
      toml_error(scene_with("type = \"ao\"\nsampling_type = \"spere\"")),
      HasSubstr("scene.toml:12:17: error: sampling_type 'spere' is not one that Penumbra reads; did you "
                "mean 'sphere'?"));
  EXPECT_EQ(warnings(good_toml(scene_with("type = \"ao\"\nexponent = 4"))),
            "scene.toml:12:1: warning: exponent has no effect with type = ao\n");
}

TEST_F(TinyRenderRenderer, ReflectionOcclusion) {
  const IntegratorSettings reflected = integrator("type = \"ro\"");
  EXPECT_EQ(kind_of(reflected), IntegratorKind::kReflectionOcclusion);
  EXPECT_EQ(param::exponent(reflected), 30);
  EXPECT_EQ(param::ray_length(reflected), 0) << "no limit";
  EXPECT_EQ(param::background(reflected), 0);
  EXPECT_EQ(param::exponent(integrator("type = \"ro\"\nexponent = 2.5")), 2.5f);
  EXPECT_THAT(toml_error(scene_with("type = \"ro\"\nexponent = -1")),
              HasSubstr("scene.toml:12:12: error: [renderer] exponent: -1 is not at least 0"));
}

TEST_F(TinyRenderRenderer, GiIsPathTracing) {
  const SceneDescription by_default = good_toml(scene_with("type = \"gi\"\nrealtime = true"));
  EXPECT_EQ(kind_of(by_default.integrator), IntegratorKind::kPath);
  EXPECT_EQ(param::direct_sampling(by_default.integrator), DirectSampling::kMis);
  EXPECT_EQ(param::max_depth(by_default.integrator), 6);
  EXPECT_EQ(by_default.sampler.spp, 100u);
  EXPECT_EQ(warnings(by_default), "");
  const SceneDescription given =
      good_toml(scene_with("type = \"gi\"\nmaxDepth = 2\nrrDepth = 3\nrrProb = 0.5\nsamplesByVertex = 7\n"
                           "isExplicit = false"));
  EXPECT_EQ(param::max_depth(given.integrator), 3);
  EXPECT_EQ(param::rr_depth(given.integrator), 4);
  EXPECT_EQ(param::direct_sampling(given.integrator), DirectSampling::kBsdfOnly);
  EXPECT_EQ(given.sampler.spp, 7u);
  EXPECT_EQ(good_toml(scene_with("type = \"gi\"\nsamplesByVertex = 7\nspp = 3")).sampler.spp, 3u);
  EXPECT_EQ(param::max_depth(integrator("type = \"gi\"\nmaxDepth = -1")), -1);
}

TEST_F(TinyRenderRenderer, Samples) {
  EXPECT_EQ(good_toml(scene_with(kDirect)).sampler.spp, 1u);
  EXPECT_EQ(good_toml(scene_with("type = \"direct\"\nspp = 17")).sampler.spp, 17u);
  EXPECT_EQ(good_toml(scene_with(kDirect)).sampler.kind, SamplerKind::kSobol);
  EXPECT_EQ(good_toml(scene_with(kDirect), {.settings = {{"sampler.sample_count", "5"}}}).sampler.spp, 5u);
  EXPECT_THAT(toml_error(scene_with("type = \"direct\"\nspp = 0")),
              HasSubstr("'0' is not in the range from 1"));
}

TEST_F(TinyRenderRenderer, OtherTypesAndNames) {
  for (const char* type : {"normal", "ssao", "simple"}) {
    EXPECT_THAT(toml_error(scene_with("type = \"" + std::string(type) + "\"\nexponent = 30")),
                AllOf(HasSubstr("scene.toml:11:8: error: renderer type '" + std::string(type) +
                                "' is not one that Penumbra reads"),
                      HasSubstr("it reads: direct, polygonal, path, gi, ao, ro\n  type = "),
                      HasSubstr("\n         ^")));
  }
  EXPECT_THAT(toml_error(scene_with("type = \"polygonol\"")), HasSubstr("did you mean 'polygonal'?"));
  const SceneDescription placeholder = good_toml(scene_with("type = \"ssao\""), {.lenient = true});
  EXPECT_EQ(kind_of(placeholder.integrator), IntegratorKind::kDirect);
  EXPECT_THAT(warnings(placeholder), HasSubstr("direct stands in for it"));
  EXPECT_THAT(
      toml_error(scene_with("type = \"direct\"\nsamplingStrategy = \"light\"")),
      HasSubstr("scene.toml:12:20: error: samplingStrategy 'light' is not one that Penumbra reads; it "
                "reads: area, bsdf, cosine, cosineHemisphere, emitter, mis, solidAngle, uniform, "
                "uniformHemisphere"));
  EXPECT_THAT(toml_error(scene_with("type = \"polygonal\"\nmethod = \"analitic\"")),
              HasSubstr("did you mean 'analytic'? it reads: analytic, area, controlVariates"));
}

TEST_F(TinyRenderRenderer, KeysOfOtherTypesHaveNoEffect) {
  const SceneDescription scene = good_toml(
      scene_with("type = \"direct\"\nalpha = 0.5\nbonus = true\ntest = true\ntraceShadows = false"));
  EXPECT_TRUE(param::trace_shadows(scene.integrator));
  EXPECT_EQ(warnings(scene),
            "scene.toml:12:1: warning: alpha has no effect with type = direct\n"
            "scene.toml:15:1: warning: traceShadows has no effect with type = direct\n");
  EXPECT_EQ(warnings(good_toml(scene_with("type = \"polygonal\"\nmethod = \"analytic\"\nvisSamples = 4"))),
            "scene.toml:13:1: warning: visSamples has no effect with method = analytic\n");
}

TEST_F(TinyRenderRenderer, WrongKinds) {
  EXPECT_THAT(toml_error(scene_with("type = 3")),
              HasSubstr("scene.toml:11:8: error: [renderer] type must be text, not an integer"));
  EXPECT_THAT(toml_error(scene_with("type = \"polygonal\"\nrealtime = \"yes\"")),
              HasSubstr("scene.toml:12:12: error: [renderer] realtime must be true or false, not text"));
  EXPECT_THAT(toml_error(scene_with("type = \"polygonal\"\nbonus = 1")),
              HasSubstr("bonus must be true or false"));
  EXPECT_THAT(toml_error(scene_with("type = \"polygonal\"\nmethod = \"controlVariates\"\nalpha = [1]")),
              HasSubstr("alpha must be a number or text, not an array of numbers"));
  EXPECT_THAT(toml_error(scene_with("type = \"polygonal\"\nmethod = \"controlVariates\"\nalpha = nan")),
              HasSubstr("[renderer] alpha: 'nan' is not a finite number"));
  EXPECT_THAT(toml_error(scene_with("type = \"direct\"\nspp = 2020-01-01")),
              HasSubstr("spp must be an integer, not a date or time"));
}

}  // namespace
}  // namespace penumbra
