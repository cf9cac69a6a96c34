// Placeholders for unsupported plugins, and settings that override the file.
#include "tests/scenes/mitsuba_text.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

TEST_F(MitsubaPlugins, LenientPlaceholders) {
  const std::string text =
      in("integrator", "vcm", "<integer name='max_depth' value='4'/>") +
      in("sensor", "spherical",
         "<float name='fov' value='30'/><float name='aperture_radius' value='1'/>" +
             in("film", "specfilm", "<integer name='width' value='99'/>" + in("rfilter", "welch")) +
             in("sampler", "magic", "<integer name='sample_count' value='3'/>")) +
      in("shape", "sphere",
         in("bsdf", "twosided", in("bsdf", "torrance", "<float name='alpha' value='.1'/>"))) +
      in("shape", "cube",
         in("bsdf", "diffuse",
            "<texture type='bitmap' name='reflectance'><string name='filename' value='x'/></texture>") +
             in("emitter", "area", "<texture type='marble' name='radiance'/>")) +
      in("shape", "hair") + in("emitter", "laser") + in("medium", "heterogeneous");
  EXPECT_FALSE(read(scene(text)));
  const SceneDescription s = good(text, {.lenient = true});
  EXPECT_EQ(kind_of(s.integrator), IntegratorKind::kVolpath);
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
          HasSubstr("integrator type 'vcm' is not one that Penumbra reads; volpath stands in"),
          HasSubstr("sensor type 'spherical'"), HasSubstr("film type 'specfilm'"),
          HasSubstr("rfilter type 'welch'"), HasSubstr("sampler type 'magic'"),
          HasSubstr("bsdf type 'torrance'"), HasSubstr("no file 'x'"), HasSubstr("texture type 'marble'"),
          HasSubstr("shape type 'hair'"), HasSubstr("emitter type 'laser'")));
}

TEST_F(MitsubaPlugins, BsdfsThatAreNotReadSayWhatIsNearest) {
  const auto message = [&](const char* type) {
    return error(scene(in("shape", "sphere", in("bsdf", type, "<string name='filename' value='a.bsdf'/>"))));
  };
  EXPECT_THAT(message("measured_polarized"),
              AllOf(HasSubstr("bsdf type 'measured_polarized' is not one that Penumbra reads"),
                    HasSubstr("'roughconductor' or a 'principled'")));
  EXPECT_THAT(message("torrance"), AllOf(HasSubstr("bsdf type 'torrance' is not one that Penumbra reads"),
                                         HasSubstr("a 'roughplastic' of the same parameters")));
}

TEST_F(MitsubaPlugins, RawConstantsAreOneValue) {
  const SceneDescription s = good(in(
      "shape", "sphere",
      in("bsdf", "principled",
         "<texture type='rawconstant' name='roughness'><float name='value' value='.25'/></texture>"
         "<texture type='rawconstant' name='base_color'><vector name='value' value='.5 .25 1'/></texture>")));
  const auto& bsdf = std::get<PrincipledBsdf>(s.bsdfs.at(0).model);
  const auto value = [&](int texture) {
    const auto& board = std::get<CheckerboardTexture>(s.textures.at(std::size_t(texture)).model);
    EXPECT_EQ(board.color0.value, board.color1.value);
    return board.color0.value;
  };
  EXPECT_EQ(value(bsdf.roughness.texture), glm::vec3(0.25f));
  EXPECT_EQ(value(bsdf.base_color.texture), glm::vec3(0.5f, 0.25f, 1));
  EXPECT_THAT(error(scene(in("shape", "sphere",
                             in("bsdf", "diffuse", "<texture type='rawconstant' name='reflectance'/>")))),
              HasSubstr("a rawconstant needs a <float name=\"value\""));
}

TEST_F(MitsubaPlugins, LenientToWhatCanBeParsed) {
  const std::string text =
      in("bsdf", "diffuse", "<rgb name='color' value='1'/><rgb name='reflectance' value='.5 2 -1'/>") +
      in("shape", "obj", "<string name='filename' value='x.obj'/>") +
      in("shape", "sphere",
         "<float name='radius' value='2'/><float name='radius' value='3'/>" +
             in("bsdf", "roughconductor", "<float name='alpha' value='-1'/>"));
  EXPECT_FALSE(read(scene(text)));
  const SceneDescription s = good(text, {.lenient = true});
  ASSERT_THAT(s.shapes, SizeIs(1));
  EXPECT_EQ(std::get<Sphere>(s.shapes[0].geometry).radius, 3.0);
  EXPECT_THAT(
      s.warnings,
      ::testing::UnorderedElementsAre(
          HasSubstr("bsdf 'diffuse' has no parameter 'color'; it is ignored"),
          HasSubstr("reflectance of bsdf 'diffuse' is negative; 0 stands in for it"),
          HasSubstr("reflectance of bsdf 'diffuse' is above 1; it is scaled down to that"),
          HasSubstr("no file 'x.obj'"), HasSubstr("the parameter 'radius' is there twice; the last counts"),
          AllOf(HasSubstr("alpha must be"), HasSubstr("its default stands in for it"))));
}

TEST_F(MitsubaPlugins, LenientWithMediaMeansVolpath) {
  const SceneDescription s =
      good(in("integrator", "vcm") + in("shape", "sphere", "<medium type='homogeneous' name='interior'/>"),
           {.lenient = true});
  EXPECT_EQ(kind_of(s.integrator), IntegratorKind::kVolpath);
}

/// Mitsuba 0.x warns of what Mitsuba 3 refuses.
TEST_F(MitsubaPlugins, AsStrictAsTheProgramThatTheFileIsFor) {
  const std::string content =
      in("integrator", "path", "<boolean name='fancy' value='true'/>") + "<sensor type='perspective'/>" +
      in("bsdf", "conductor", "<float name='alpha' value='.1'/><string name='distribution' value='ggx'/>") +
      in("bsdf", "ward", "<float name='alpha' value='.1'/>") +
      in("bsdf", "ward", "<float name='alpha' value='.2'/>") +
      in("bsdf", "roughplastic",
         "<string name='distribution' value='phong'/><float name='alpha' value='.3'/>") +
      in("shape", "sphere",
         in("bsdf", "diffuse",
            "<rgb name='reflectance' value='.1 .2 .3'/><rgb name='reflectance' value='4 2 1'/>"));
  const auto of_version = [&](const std::string& version) {
    return "<scene version='" + version + "'>" + content + "</scene>";
  };
  const auto old = read(of_version("0.6.0"));
  ASSERT_TRUE(old) << old.error().message;
  const auto& diffuse = std::get<DiffuseBsdf>(old->bsdfs.at(std::size_t(old->shapes.at(0).front_bsdf)).model);
  EXPECT_EQ(diffuse.reflectance.value, glm::vec3(1.0f, 0.5f, 0.25f));
  EXPECT_THAT(lit(*old).warnings,
              ::testing::UnorderedElementsAre(
                  HasSubstr("integrator 'path' has no parameter 'fancy'; it is ignored"),
                  HasSubstr("bsdf 'conductor' has no parameter 'alpha'; it is ignored"),
                  HasSubstr("bsdf 'conductor' has no parameter 'distribution'; it is ignored"),
                  HasSubstr("bsdf 'ward' has no parameter 'alpha'; it is ignored (2 times)"),
                  HasSubstr("beckmann of the same alpha stands in for the distribution 'phong'"),
                  HasSubstr("the parameter 'reflectance' is there twice; the last counts"),
                  HasSubstr("reflectance of bsdf 'diffuse' is above 1; it is scaled down to that")));
  for (const char* version : {"2.0.0", "3.0.0"})
    EXPECT_THAT(error(of_version(version)), HasSubstr("'reflectance' is there twice"));
  EXPECT_THAT(error(scene(in("bsdf", "conductor", "<float name='alpha' value='.1'/>"))),
              HasSubstr("no parameter 'alpha'"));
}

TEST_F(MitsubaPlugins, StrictnessMakesErrorsOfWarnings) {
  const std::string text = scene(in("shape", "hair") + in("emitter", "constant"));
  EXPECT_TRUE(read(text, {.lenient = true}));
  EXPECT_THAT(error(text, {.lenient = true, .strict = true}), HasSubstr("shape type 'hair' is not one"));
  EXPECT_TRUE(read(scene(in("shape", "sphere") + in("emitter", "constant")), {.strict = true}));
}

/// What is wrong with an integrator, a sampler and a film does not matter where the command line replaces
/// them.
TEST_F(MitsubaPlugins, WhatTheCommandLineReplacesIsNotLookedAt) {
  const std::string text =
      in("integrator", "vcm", "<float name='fancy' value='1'/><integer name='max_depth' value='7'/>") +
      in("sensor", "perspective",
         in("sampler", "magic", "<integer name='sample_count' value='9'/>") +
             in("film", "hdrfilm", "<integer name='width' value='-5'/>"));
  EXPECT_FALSE(read(scene(text)));
  const SceneDescription s = good(
      text, {.settings = {{"integrator.type", "volpath"}, {"sampler.type", "sobol"}, {"film.width", "50"}}});
  EXPECT_EQ(kind_of(s.integrator), IntegratorKind::kVolpath);
  EXPECT_EQ(param::max_depth(s.integrator), 7);
  EXPECT_EQ(s.sampler.spp, 9u);
  EXPECT_EQ(s.film.width, 50);
  EXPECT_THAT(s.warnings, IsEmpty());
}

TEST_F(MitsubaPlugins, LeniencyHasItsLimits) {
  const ReadOptions lenient{.lenient = true};
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
