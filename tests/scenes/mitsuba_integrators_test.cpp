// Conversion of Mitsuba's integrators.
#include "tests/scenes/mitsuba_text.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

TEST_F(MitsubaPlugins, Integrators) {
  const auto integrator = [&](std::string_view type, std::string_view inside = "") {
    return good(in("integrator", type, inside)).integrator;
  };
  EXPECT_EQ(kind_of(good("").integrator), IntegratorKind::kPath);
  EXPECT_EQ(param::max_depth(integrator("path")), -1);
  EXPECT_EQ(param::max_depth(integrator("path", "<integer name='max_depth' value='65'/>")), 65);
  EXPECT_EQ(param::direct_sampling(integrator("path_mats")), DirectSampling::kBsdfOnly);
  EXPECT_EQ(param::direct_sampling(integrator("path_ems")), DirectSampling::kEmitterOnly);
  EXPECT_EQ(param::direct_sampling(integrator("path_mis")), DirectSampling::kMis);
  EXPECT_EQ(param::direct_sampling(integrator("path", "<string name='direct_sampling' value='ems'/>")),
            DirectSampling::kEmitterOnly);
  const IntegratorSettings both = integrator("direct", "<integer name='shading_samples' value='4'/>");
  EXPECT_EQ(kind_of(both), IntegratorKind::kDirect);
  EXPECT_EQ(param::emitter_samples(both), 4);
  EXPECT_EQ(param::bsdf_samples(both), 4);
  const IntegratorSettings chosen =
      integrator("direct",
                 "<integer name='emitter_samples' value='2'/><integer name='bsdf_samples' value='0'/>"
                 "<string name='bsdf_sampling' value='cosine'/><string name='emitter_sampling' value='area'/>"
                 "<string name='mis' value='power'/><boolean name='hide_emitters' value='true'/>");
  EXPECT_EQ(param::emitter_samples(chosen), 2);
  EXPECT_EQ(param::bsdf_samples(chosen), 0);
  EXPECT_EQ(param::bsdf_sampling(chosen), BsdfSampling::kCosine);
  EXPECT_EQ(param::emitter_sampling(chosen), EmitterSampling::kArea);
  EXPECT_EQ(param::heuristic(chosen), MisHeuristic::kPower);
  EXPECT_TRUE(chosen.hide_emitters);
  const IntegratorSettings ambient =
      integrator("ao", "<integer name='shadingSamples' value='3'/><float name='rayLength' value='-1'/>");
  EXPECT_EQ(kind_of(ambient), IntegratorKind::kAmbientOcclusion);
  EXPECT_EQ(param::vis_samples(ambient), 3);
  EXPECT_EQ(param::ray_length(ambient), -1);
  EXPECT_EQ(param::background(ambient), 1);
  const IntegratorSettings whitted = integrator(
      "whitted",
      "<integer name='max_depth' value='4'/><integer name='branch_depth' value='2'/>"
      "<integer name='indirect_samples' value='5'/><string name='indirect_sampling' value='uniform'/>");
  EXPECT_EQ(kind_of(whitted), IntegratorKind::kWhitted);
  EXPECT_EQ(param::max_depth(whitted), 4);
  EXPECT_EQ(param::branch_depth(whitted), 2);
  EXPECT_EQ(param::indirect_samples(whitted), 5);
  EXPECT_EQ(param::indirect_sampling(whitted), IndirectSampling::kUniform);
  EXPECT_EQ(param::exponent(integrator("ro", "<float name='exponent' value='7.5'/>")), 7.5f);
  const std::string inner = in("integrator", "path", "<integer name='max_depth' value='3'/>");
  const std::string aov = in("integrator", "aov", "<string name='aovs' value='d:depth'/>" + inner);
  EXPECT_EQ(param::max_depth(integrator("moment", aov)), 3);
}

TEST_F(MitsubaPlugins, HiddenEmittersAreAsInTheFilesMitsuba) {
  const auto hidden = [&](const std::string& version, std::string_view more = "") {
    const auto s =
        read("<scene version='" + version + "'>" +
             in("integrator", "path", "<boolean name='hide_emitters' value='true'/>" + std::string(more)) +
             "<sensor type='perspective'/></scene>");
    EXPECT_TRUE(s) << s.error().message;
    EXPECT_TRUE(s->integrator.hide_emitters);
    return s->integrator.hidden_emitters;
  };
  for (const std::string version : {"0.5.0", "0.6.0", "2.0.0", "2.1.0"})
    EXPECT_EQ(hidden(version), HiddenEmitters::kUnlit) << version;
  for (const std::string version : {"3.0.0", "3.7.0", "3.9.1"})
    EXPECT_EQ(hidden(version), HiddenEmitters::kLookedThrough) << version;
  EXPECT_EQ(hidden("3.0.0", "<string name='hidden_emitters' value='unlit'/>"), HiddenEmitters::kUnlit);
  EXPECT_EQ(hidden("0.6.0", "<string name='hidden_emitters' value='looked_through'/>"),
            HiddenEmitters::kLookedThrough);
  // The version is the scene's, whatever file has the integrator.
  write("part.xml", "<scene version='3.0.0'>" + in("integrator", "path") + "</scene>");
  EXPECT_EQ(read("<scene version='0.6.0'><include filename='part.xml'/><sensor type='perspective'/></scene>")
                .value()
                .integrator.hidden_emitters,
            HiddenEmitters::kUnlit);
}

TEST_F(MitsubaPlugins, IntegratorErrors) {
  const auto message = [&](std::string_view type, std::string_view inside = "") {
    return error(scene(in("integrator", type, inside)));
  };
  EXPECT_THAT(message("direct", "<integer name='max_depth' value='3'/>"),
              AllOf(HasSubstr("integrator 'direct' has no parameter 'max_depth'"),
                    HasSubstr("It has: shading_samples")));
  EXPECT_THAT(message("path", "<integer name='max_depth' value='-2'/>"),
              HasSubstr("max_depth: '-2' is not in the range from -1"));
  EXPECT_THAT(message("path", "<integer name='rr_depth' value='0'/>"), HasSubstr("from 1 to"));
  EXPECT_THAT(message("direct", "<integer name='shading_samples' value='0'/>"), HasSubstr("from 1 to"));
  EXPECT_THAT(message("direct",
                      "<integer name='emitter_samples' value='0'/><integer name='bsdf_samples' value='0'/>"),
              HasSubstr("at least one of emitter_samples and bsdf_samples"));
  EXPECT_THAT(message("moment"), HasSubstr("needs an <integrator>"));
  EXPECT_THAT(message("stokes"), HasSubstr("needs an <integrator>"));
  EXPECT_THAT(message("vcm"), HasSubstr("integrator type 'vcm' is not one that Penumbra reads"));
  EXPECT_THAT(error(scene("<integrator type='moment' id='a'><ref id='a'/></integrator>")),
              HasSubstr("needs an <integrator>"));
  EXPECT_THAT(error(scene(in("integrator", "path") + in("integrator", "path"))),
              HasSubstr("2 of <integrator>"));
}

}  // namespace
}  // namespace penumbra
