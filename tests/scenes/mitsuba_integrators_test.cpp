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

TEST_F(MitsubaPlugins, PhotonMapsHaveTheDefaultsOfMitsuba) {
  const SceneDescription plain = good(in("integrator", "photonmapper"));
  const auto& map = *plain.integrator.get<PhotonMapIntegrator>();
  EXPECT_EQ(map.max_depth, -1);
  EXPECT_EQ(map.rr_depth, 5);
  EXPECT_EQ(map.global_photons, 250'000);
  EXPECT_EQ(map.caustic_photons, 250'000);
  EXPECT_EQ(map.volume_photons, 250'000);
  EXPECT_EQ(map.global_lookup_radius, 0.05f);
  EXPECT_EQ(map.caustic_lookup_radius, 0.0125f);
  EXPECT_EQ(map.photon_radius, 0.0f);
  EXPECT_EQ(map.lookup_size, 120);
  EXPECT_FALSE(map.final_gather);
  for (const char* type : {"ppm", "sppm"}) {
    const SceneDescription progressive = good(in("integrator", type));
    ASSERT_TRUE(progressive.integrator.is<ProgressivePhotonIntegrator>()) << type;
    const auto& ppm = *progressive.integrator.get<ProgressivePhotonIntegrator>();
    EXPECT_EQ(ppm.max_depth, -1);
    EXPECT_EQ(ppm.photon_count, 250'000);
    EXPECT_EQ(ppm.initial_radius, 0.0f);
    EXPECT_EQ(ppm.alpha, 0.7f) << "not that of the control variate of path";
    EXPECT_THAT(progressive.warnings, IsEmpty());
  }
}

TEST_F(MitsubaPlugins, PhotonMapsInBothSpellings) {
  const std::string old_spelling =
      "<integer name='maxDepth' value='9'/><integer name='rrDepth' value='7'/>"
      "<integer name='globalPhotons' value='1000'/><integer name='causticPhotons' value='0'/>"
      "<integer name='volumePhotons' value='3000'/><float name='globalLookupRadius' value='0.1'/>"
      "<float name='causticLookupRadius' value='0.2'/><integer name='lookupSize' value='60'/>"
      "<integer name='directSamples' value='4'/><integer name='glossySamples' value='8'/>"
      "<integer name='maxSpecularDepth' value='4'/><integer name='granularity' value='100'/>"
      "<boolean name='hideEmitters' value='true'/>";
  const std::string new_spelling =
      "<integer name='max_depth' value='9'/><integer name='rr_depth' value='7'/>"
      "<integer name='global_photons' value='1000'/><integer name='caustic_photons' value='0'/>"
      "<integer name='volume_photons' value='3000'/><float name='global_lookup_radius' value='0.1'/>"
      "<float name='caustic_lookup_radius' value='0.2'/><integer name='lookup_size' value='60'/>"
      "<integer name='direct_samples' value='4'/><boolean name='hide_emitters' value='true'/>";
  for (const std::string& text : {old_spelling, new_spelling}) {
    const SceneDescription s = good(in("integrator", "photonmapper", text));
    ASSERT_TRUE(s.integrator.is<PhotonMapIntegrator>());
    const auto& map = *s.integrator.get<PhotonMapIntegrator>();
    EXPECT_EQ(map.max_depth, 9);
    EXPECT_EQ(map.rr_depth, 7);
    EXPECT_EQ(map.global_photons, 1000);
    EXPECT_EQ(map.caustic_photons, 0);
    EXPECT_EQ(map.volume_photons, 3000);
    EXPECT_EQ(map.global_lookup_radius, 0.1f);
    EXPECT_EQ(map.caustic_lookup_radius, 0.2f);
    EXPECT_EQ(map.lookup_size, 60);
    EXPECT_TRUE(s.integrator.hide_emitters);
    EXPECT_THAT(s.warnings, IsEmpty()) << "they cost time, and the image is the same";
  }
}

TEST_F(MitsubaPlugins, AnIrradianceCacheOfAPhotonMapGathers) {
  const SceneDescription s = good(in("integrator", "irrcache", in("integrator", "photonmapper")));
  ASSERT_TRUE(s.integrator.is<PhotonMapIntegrator>());
  EXPECT_TRUE(s.integrator.get<PhotonMapIntegrator>()->final_gather);
  EXPECT_THAT(s.warnings, ElementsAre(HasSubstr("photonmapper is rendered without its cache")));
}

TEST_F(MitsubaPlugins, ProgressivePhotonMapsAreAsManyAsSamples) {
  for (const char* type : {"ppm", "sppm"}) {
    const SceneDescription s = good(
        in("integrator", type,
           "<integer name='maxDepth' value='9'/><integer name='photonCount' value='1000'/><float "
           "name='initialRadius' value='0.25'/><float name='alpha' value='0.5'/><integer name='granularity' "
           "value='1'/><integer name='rrDepth' value='3'/><integer name='maxPasses' value='20'/>"));
    ASSERT_TRUE(s.integrator.is<ProgressivePhotonIntegrator>()) << type;
    const auto& ppm = *s.integrator.get<ProgressivePhotonIntegrator>();
    EXPECT_EQ(ppm.max_depth, 9);
    EXPECT_EQ(ppm.rr_depth, 3);
    EXPECT_EQ(ppm.photon_count, 1000);
    EXPECT_EQ(ppm.initial_radius, 0.25f);
    EXPECT_EQ(ppm.alpha, 0.5f);
    EXPECT_THAT(s.warnings, ElementsAre(AllOf(HasSubstr("max_passes is ignored"),
                                              HasSubstr("the samples per pixel decide"))));
  }
}

TEST_F(MitsubaPlugins, PhotonMapsSeeMedia) {
  for (const char* type : {"photonmapper", "ppm", "sppm"})
    EXPECT_THAT(good(in("integrator", type) +
                     "<shape type='sphere'><bsdf type='null'/><medium type='homogeneous' name='interior'/>"
                     "</shape>")
                    .warnings,
                IsEmpty())
        << type;
}

TEST_F(MitsubaPlugins, ErrorsOfPhotonMaps) {
  const auto message = [&](std::string_view type, std::string_view inside) {
    return error(scene(in("integrator", type, inside)));
  };
  EXPECT_THAT(message("photonmapper", "<integer name='globalPhotons' value='1000000000'/>"),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("global_photons"), HasSubstr("from 0 to 16777216")));
  EXPECT_THAT(message("photonmapper", "<integer name='photonCount' value='9'/>"),
              HasSubstr("integrator 'photonmapper' has no parameter 'photon_count'"));
  EXPECT_THAT(message("photonmapper", "<integer name='maxPasses' value='9'/>"),
              HasSubstr("integrator 'photonmapper' has no parameter 'max_passes'"));
  EXPECT_THAT(message("sppm", "<float name='alpha' value='1.5'/>"),
              AllOf(HasSubstr("alpha = 1.5"), HasSubstr("above 0 and up to 1")));
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
