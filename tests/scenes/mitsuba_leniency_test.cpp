// What stands in for plugins that are not read, and settings that override the file.
#include "tests/scenes/mitsuba_text.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

TEST_F(MitsubaPlugins, LenientStandIns) {
  const std::string text =
      in("integrator", "vcm", "<integer name='max_depth' value='4'/>") +
      in("sensor", "spherical",
         "<float name='fov' value='30'/><float name='aperture_radius' value='1'/>" +
             in("film", "specfilm", "<integer name='width' value='99'/>" + in("rfilter", "welch")) +
             in("sampler", "magic", "<integer name='sample_count' value='3'/>")) +
      in("shape", "sphere", in("bsdf", "twosided", in("bsdf", "hair", "<float name='alpha' value='.1'/>"))) +
      in("shape", "cube",
         in("bsdf", "diffuse",
            "<texture type='bitmap' name='reflectance'><string name='filename' value='x'/></texture>") +
             in("emitter", "area", "<texture type='marble' name='radiance'/>")) +
      in("shape", "hair") + in("emitter", "laser") + in("medium", "heterogeneous");
  EXPECT_FALSE(read(scene(text)));
  const SceneDescription s = good(text, {.lenient = true});
  EXPECT_EQ(kind_of(s.integrator), IntegratorKind::kPath);
  EXPECT_EQ(param::max_depth(s.integrator), 4);
  EXPECT_EQ(s.camera.fov, 30.0);
  EXPECT_EQ(s.film.width, 99);
  EXPECT_EQ(s.sampler.spp, 3u);
  ASSERT_THAT(s.shapes, SizeIs(2));
  EXPECT_EQ(s.shapes[0].front_bsdf, s.shapes[0].back_bsdf);
  const auto reflectance = [&](std::size_t shape) {
    return std::get<DiffuseBsdf>(s.bsdfs.at(std::size_t(s.shapes[shape].front_bsdf)).model).reflectance;
  };
  EXPECT_EQ(reflectance(0), glm::vec3(0.8f, 0.2f, 0.8f));
  ASSERT_EQ(reflectance(1).texture, 0);
  EXPECT_EQ(std::get<CheckerboardTexture>(s.textures.at(0).model).color0, glm::vec3(0.8f, 0.2f, 0.8f));
  EXPECT_EQ(s.shapes[1].back_bsdf, kBlackBsdf);
  const int shown = s.shapes[1].radiance_texture;
  ASSERT_EQ(shown, 1);
  EXPECT_EQ(std::get<CheckerboardTexture>(s.textures.at(std::size_t(shown)).model).color0,
            glm::vec3(0.8f, 0.2f, 0.8f));
  EXPECT_EQ(only<ConstantEnvironment>(s).radiance, glm::vec3(0.8f, 0.2f, 0.8f));
  EXPECT_THAT(
      s.warnings,
      ::testing::UnorderedElementsAre(
          HasSubstr("integrator type 'vcm' is not one that Penumbra reads; path stands in"),
          HasSubstr("sensor type 'spherical'"), HasSubstr("film type 'specfilm'"),
          HasSubstr("rfilter type 'welch'"), HasSubstr("sampler type 'magic'"), HasSubstr("bsdf type 'hair'"),
          HasSubstr("no file 'x'"), HasSubstr("texture type 'marble'"), HasSubstr("shape type 'hair'"),
          HasSubstr("emitter type 'laser'"), HasSubstr("passes through media as if they were not there")));
}

TEST_F(MitsubaPlugins, LeniencyIsForPluginsOnly) {
  const ReadOptions lenient{.lenient = true};
  EXPECT_THAT(error(scene(in("bsdf", "diffuse", "<rgb name='color' value='1'/>")), lenient),
              HasSubstr("no parameter 'color'"));
  EXPECT_THAT(error(scene("<shaep type='sphere'/>"), lenient), HasSubstr("did you mean 'shape'?"));
  EXPECT_THAT(error(scene(in("shape", "sphere", "<ref id='x'/>")), lenient),
              HasSubstr("no object with the id 'x'"));
}

TEST_F(MitsubaPlugins, SettingsOverrideTheFile) {
  const std::string text =
      in("integrator", "path", "<integer name='max_depth' value='4'/>") +
      in("sensor", "perspective",
         in("film", "hdrfilm", "<integer name='width' value='100'/><integer name='crop_width' value='80'/>"));
  // Whatever their order: a film of 50 pixels holds a window of 50.
  const SceneDescription s = good(text, {.settings = {{"film.cropWidth", "50"},
                                                      {"integrator.max_depth", "9"},
                                                      {"film.width", "50"},
                                                      {"film.width", "60"}}});
  EXPECT_EQ(param::max_depth(s.integrator), 9);
  EXPECT_EQ(s.film.width, 60);
  EXPECT_EQ(s.film.crop_width, 50);
  EXPECT_THAT(error(scene(text), {.settings = {{"film.width", "50"}}}),
              HasSubstr("is not inside the film of 50 x 576"));
  EXPECT_THAT(error(scene(text), {.settings = {{"integrator.beta", "auto"}}}),
              HasSubstr("no setting 'integrator.beta'"));
}

}  // namespace
}  // namespace penumbra
