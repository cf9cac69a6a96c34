// Scenes of Rainbow: Mitsuba's elements with rules of their own.
#include <gmock/gmock.h>

#include "scenes/transform.h"
#include "tests/scenes/mitsuba_text.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

class RainbowScenes : public MitsubaPlugins {
 protected:
  static std::string rainbow(const std::string& content, const std::string& camera = "") {
    return "<scene>\n<mode type='final'/>\n<integrator type='path'><integer name='maxDepth' "
           "value='8'/><integer "
           "name='sampleNum' value='3'/><integer name='delta' value='9'/></integrator>\n<camera "
           "type='perspective'>" +
           camera +
           "<hide type='sobol'/><sampler type='halton'><integer name='sampleCount' "
           "value='512'/></sampler><film "
           "type='ldrfilm'><integer name='width' value='20'/><integer name='height' "
           "value='10'/></film></camera>\n" +
           content + "\n</scene>";
  }
  SceneDescription good_rainbow(const std::string& content, const std::string& camera = "") {
    return lit(good_of(read(rainbow(content, camera))));
  }
  template <typename Model>
  static const Model& front(const SceneDescription& scene) {
    return std::get<Model>(scene.bsdfs.at(std::size_t(scene.shapes.at(0).front_bsdf)).model);
  }
};

TEST_F(RainbowScenes, ItsElementsAreKnownAndWhatIsHiddenIsNot) {
  const SceneDescription s = good_rainbow(
      "<hide type='spot'/><shape type='sphere'><integer name='subdiv' value='200'/><bsdf type='matte'><hide "
      "name='albedo' value='1'/><color name='albedo' value='.25,.5,1'/></bsdf></shape>");
  EXPECT_THAT(s.dialect, HasSubstr("rainbow (it has a <mode>)"));
  EXPECT_THAT(s.warnings, IsEmpty());
  EXPECT_EQ(s.sampler.spp, 3u) << "the integrator's number counts";
  EXPECT_EQ(param::max_depth(s.integrator), 9) << "Rainbow counts bounces";
  EXPECT_EQ(front<DiffuseBsdf>(s).reflectance, glm::vec3(0.25f, 0.5f, 1));
  EXPECT_EQ(s.shapes[0].front_bsdf, s.shapes[0].back_bsdf) << "both sides reflect";
  EXPECT_EQ(s.film.width, 20);
  EXPECT_THAT(error(rainbow("\n<rainbow/>")), HasSubstr("scene.xml:6:2: error: <rainbow> is not an element"));
}

TEST_F(RainbowScenes, OtherSignsOfIt) {
  const auto dialect = [&](const std::string& content) {
    return good_of(read("<scene version='0.5.0'>" + content + "<sensor type='perspective'/></scene>"))
        .dialect;
  };
  EXPECT_THAT(dialect("<hide/>"), HasSubstr("<hide>"));
  const std::string samples = "<integer name='sampleNum' value='4'/>";
  EXPECT_THAT(
      dialect("<integrator type='path'>" + samples + "<integer name='delta' value='1'/></integrator>"),
      HasSubstr("sampleNum"));
  EXPECT_EQ(dialect("<integrator type='path'>" + samples + "</integrator>"), "") << "others have it, too";
  EXPECT_EQ(dialect("<integrator type='path'/>"), "");
}

TEST_F(RainbowScenes, MediaScatterAloneByDefault) {
  const SceneDescription s = good_of(
      read("<scene><mode type='final'/><integrator type='volpath'><integer name='maxDepth' "
           "value='9223372036854775807'/></integrator><shape type='sphere'><medium type='homogeneous' "
           "name='interior'><float name='g' value='.5'/></medium></shape></scene>"));
  ASSERT_EQ(s.media.size(), 1u);
  EXPECT_EQ(s.media[0].extinction, glm::vec3(1));
  EXPECT_EQ(s.media[0].albedo, glm::vec3(1));
  ASSERT_EQ(s.media[0].phase.size(), 1u);
  EXPECT_EQ(s.media[0].phase[0].g, 0.5f);
}

/// Steps multiply in the order in which they are written, so the last moves a point first.
TEST_F(RainbowScenes, TransformsAreInTheOtherOrder) {
  const SceneDescription s = good_rainbow(
      "<shape type='cube'>" + to_world("<scale value='2 2 2'/><translate x='1' y='0' z='0'/>") + "</shape>");
  double most = -9;
  for (const auto& position : std::get<Mesh>(s.shapes.at(0).geometry).positions)
    most = std::max(most, position.x);
  EXPECT_EQ(most, 4.0) << "2 (1 + 1)";
}

/// The film is mirrored: a look-at that begins with a mirror image looks as it does without in Mitsuba.
TEST_F(RainbowScenes, TheCameraIsMirroredAndItsAngleIsVertical) {
  const SceneDescription s = good_rainbow(
      "", "<transform name='toWorld'><lookat origin='0,0,5' target='0,0,0' up='0,1,0'/></transform>");
  const auto plain = look_at(glm::dvec3(0, 0, 5), glm::dvec3(0), glm::dvec3(0, 1, 0));
  ASSERT_TRUE(plain);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(s.camera.to_world[i], (i == 0 ? -1.0 : 1.0) * (*plain)[i]) << i;
  EXPECT_EQ(s.camera.fov, 30.0);
  EXPECT_EQ(s.camera.fov_axis, FovAxis::kY);
}

TEST_F(RainbowScenes, MaterialsHaveItsNamesAndDefaults) {
  const auto shown = [&](const std::string& bsdf) {
    return good_rainbow("<shape type='sphere'>" + bsdf + "</shape>");
  };
  const SceneDescription glass = shown("<bsdf type='glass'><float name='etaT' value='1.25'/></bsdf>");
  EXPECT_EQ(front<DielectricBsdf>(glass).int_ior, 1.25f);
  EXPECT_EQ(front<DielectricBsdf>(glass).ext_ior, 1.0f);
  const SceneDescription mirror =
      shown("<bsdf type='mirror'><rgb name='reflectance' value='.5 .5 .5'/></bsdf>");
  EXPECT_EQ(front<ConductorBsdf>(mirror).specular_reflectance.value, glm::vec3(0.5f));
  const SceneDescription copper = shown(
      "<bsdf type='roughconductor'><string name='material' value='Au'/><float name='alpha' "
      "value='.2'/></bsdf>");
  EXPECT_EQ(front<RoughConductorBsdf>(copper).eta.value, glm::vec3(0.200438f, 0.924033f, 1.10221f));
  EXPECT_THAT(warnings(copper), HasSubstr("not its name; those of copper are its defaults"));
  const SceneDescription unknown = good_rainbow(
      "<bsdf type='?' id='a'><bsdf type='dielectric'/></bsdf><shape type='sphere'><ref "
      "id='a'/></shape>");
  EXPECT_EQ(front<DielectricBsdf>(unknown).int_ior, 1.5f);
  EXPECT_THAT(warnings(unknown), HasSubstr("bsdf type '?' is the dielectric inside it"));
  const SceneDescription held = shown("<bsdf type='twosided'><bsdf type='diffuse'/></bsdf>");
  EXPECT_EQ(held.shapes.at(0).front_bsdf, held.shapes.at(0).back_bsdf);
}

TEST_F(RainbowScenes, Lights) {
  const SceneDescription s = good_rainbow(
      "<shape type='rectangle'><emitter type='area'><rgb name='radiance' value='1 2 3'/><float name='scale' "
      "value='3'/></emitter></shape><emitter type='spot'><float name='totalAngle' value='60'/></emitter>");
  EXPECT_EQ(*s.shapes.at(0).radiance, glm::vec3(3, 6, 9));
  EXPECT_EQ(only<SpotLight>(s).cutoff_angle, 60.0);
  EXPECT_EQ(only<SpotLight>(s).beam_width, 45.0);
  EXPECT_THAT(warnings(s), HasSubstr("fades out by the fourth power"));
  EXPECT_EQ(
      only<SpotLight>(good_rainbow("<emitter type='spot'><float name='totalAngle' value='9'/></emitter>"))
          .cutoff_angle,
      45.0)
      << "the beam is wider";
}

}  // namespace
}  // namespace penumbra
