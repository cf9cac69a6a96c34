// [renderer] of TinyRender scenes: every type and method as settings of ours.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scenes/tinyrender_text.h"

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
    EXPECT_EQ(s.kind, IntegratorKind::kDirect);
    EXPECT_EQ(s.emitter_samples, emitter_samples);
    EXPECT_EQ(s.bsdf_samples, bsdf_samples);
    EXPECT_EQ(s.emitter_sampling, emitter_sampling);
    EXPECT_EQ(s.bsdf_sampling, bsdf_sampling);
    EXPECT_EQ(s.heuristic, MisHeuristic::kBalance);
    EXPECT_TRUE(s.trace_shadows);
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
  EXPECT_EQ(by_default.emitter_samples, 1);
  EXPECT_EQ(by_default.bsdf_samples, 1);
}

TEST_F(TinyRenderRenderer, DirectCounts) {
  const IntegratorSettings both = integrator("type = \"direct\"\nemitterSamples = 64\nbsdfSamples = 32");
  EXPECT_EQ(both.emitter_samples, 64);
  EXPECT_EQ(both.bsdf_samples, 32);
  EXPECT_EQ(integrator("type = \"direct\"\nemitterSamples = 0\nbsdfSamples = 64").emitter_samples, 0);
  EXPECT_EQ(integrator("type = \"direct\"\nemitterSamples = 64\nbsdfSamples = 0").bsdf_samples, 0);
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
  EXPECT_EQ(unused.integrator.bsdf_samples, 0);
  EXPECT_EQ(warnings(unused),
            "scene.toml:13:15: warning: bsdfSamples has no effect with samplingStrategy = emitter\n");
}

TEST_F(TinyRenderRenderer, PolygonalMethods) {
  EXPECT_EQ(integrator("type = \"polygonal\"\nmethod = \"analytic\"").kind, IntegratorKind::kPolygonAnalytic);
  for (const char* text : {"type = \"polygonal\"\nmethod = \"area\"", "type = \"polygonal\"",
                           "type = \"polygonal\"\nrealtime = false\ntraceShadows = false"}) {
    const IntegratorSettings area = integrator(text);
    EXPECT_EQ(area.kind, IntegratorKind::kPolygonArea) << text;
    EXPECT_EQ(area.emitter_samples, 1);
    EXPECT_FALSE(area.trace_shadows);
  }
  EXPECT_TRUE(integrator("type = \"polygonal\"\nmethod = \"area\"\ntraceShadows = true").trace_shadows);
  for (const char* method : {"controlVariates", "control_variates", "ControlVariates"}) {
    const IntegratorSettings cv = integrator("type = \"polygonal\"\nmethod = \"" + std::string(method) +
                                             "\"\nalpha = 0.75\nvisSamples = 4\nbonus = true");
    EXPECT_EQ(cv.kind, IntegratorKind::kPolygonCv);
    EXPECT_EQ(cv.alpha, 0.75f);
    EXPECT_EQ(cv.vis_samples, 4);
    EXPECT_EQ(cv.estimator, CvEstimator::kCv);
    EXPECT_EQ(cv.emitter_sampling, EmitterSampling::kArea);
  }
  const IntegratorSettings by_default = integrator("type = \"polygonal\"\nmethod = \"controlVariates\"");
  EXPECT_EQ(by_default.alpha, 1.0f);
  EXPECT_EQ(by_default.vis_samples, 1);
  EXPECT_EQ(integrator("type = \"polygonal\"\nmethod = \"controlVariates\"\nalpha = 1").alpha, 1.0f);
  EXPECT_EQ(integrator("type = \"polygonal\"\nmethod = \"controlVariates\"\nalpha = \"auto\"").alpha,
            std::nullopt);
}

TEST_F(TinyRenderRenderer, TheWindowsPicture) {
  EXPECT_EQ(integrator("type = \"polygonal\"\nrealtime = true").kind, IntegratorKind::kPolygonAnalytic);
  EXPECT_EQ(integrator("type = \"polygonal\"\nrealtime = true\ntest = false").kind,
            IntegratorKind::kPolygonAnalytic);
  const IntegratorSettings hybrid = integrator("type = \"polygonal\"\nrealtime = true\ntest = true");
  EXPECT_EQ(hybrid.kind, IntegratorKind::kPolygonCv);
  EXPECT_EQ(hybrid.alpha, 1.0f);
  EXPECT_EQ(integrator("type = \"polygonal\"\nrealtime = true\ntest = true\nmethod = \"area\"").kind,
            IntegratorKind::kPolygonArea);
  EXPECT_EQ(integrator("type = \"polygonal\"\nrealtime = true\nmethod = \"controlVariates\"").kind,
            IntegratorKind::kPolygonCv);
  const SceneDescription other = good_toml(scene_with("type = \"direct\"\nrealtime = true"));
  EXPECT_EQ(warnings(other),
            "scene.toml:12:12: warning: what the window shows for type = direct is not read; it "
            "is rendered offline\n");
}

TEST_F(TinyRenderRenderer, PathDepthIsInEdges) {
  EXPECT_EQ(integrator("type = \"path\"").kind, IntegratorKind::kPath);
  EXPECT_EQ(integrator("type = \"path\"").max_depth, -1);
  EXPECT_EQ(integrator("type = \"path\"\nmaxDepth = -1").max_depth, -1);
  EXPECT_EQ(integrator("type = \"path\"\nmaxDepth = 0").max_depth, 1) << "emitters only";
  EXPECT_EQ(integrator("type = \"path\"\nmaxDepth = 4\nrrDepth = 3\nrrProb = 0.9").max_depth, 5);
  EXPECT_EQ(integrator("type = \"path\"\nmaxDepth = 4\nrrDepth = 3").rr_depth, 4);
  EXPECT_EQ(integrator("type = \"path\"\nisExplicit = true").direct_sampling, DirectSampling::kMis);
  EXPECT_EQ(integrator("type = \"path\"\nisExplicit = false").direct_sampling, DirectSampling::kBsdfOnly);
  EXPECT_THAT(toml_error(scene_with("type = \"path\"\nmaxDepth = -2")),
              HasSubstr("scene.toml:12:12: error: -2 is not in the range from -1 to 2147483646"));
  EXPECT_THAT(toml_error(scene_with("type = \"path\"\nmaxDepth = 2147483647")),
              HasSubstr("not in the range"));
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
  for (const char* type : {"normal", "ao", "ro", "simple", "gi"}) {
    EXPECT_THAT(toml_error(scene_with("type = \"" + std::string(type) + "\"\nexponent = 30")),
                AllOf(HasSubstr("scene.toml:11:8: error: renderer type '" + std::string(type) +
                                "' is not one that Penumbra reads"),
                      HasSubstr("it reads: direct, polygonal, path\n  type = "), HasSubstr("\n         ^")));
  }
  EXPECT_THAT(toml_error(scene_with("type = \"polygonol\"")), HasSubstr("did you mean 'polygonal'?"));
  const SceneDescription stand_in = good_toml(scene_with("type = \"ao\""), {.lenient = true});
  EXPECT_EQ(stand_in.integrator.kind, IntegratorKind::kDirect);
  EXPECT_THAT(warnings(stand_in), HasSubstr("direct stands in for it"));
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
  EXPECT_TRUE(scene.integrator.trace_shadows);
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
