// Conversion of Mitsuba's emitters.
#include "tests/scenes/mitsuba_text.h"

namespace penumbra {
namespace {

TEST_F(MitsubaPlugins, Lights) {
  const SceneDescription s = good(
      in("emitter", "point", "<rgb name='intensity' value='7'/><point name='position' x='1' y='2' z='3'/>") +
      in("emitter", "constant", "<rgb name='radiance' value='.5'/>") +
      in("shape", "rectangle", in("emitter", "area", "<rgb name='radiance' value='1 2 3'/>")));
  EXPECT_EQ(only<PointLight>(s).position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(only<PointLight>(s).intensity, glm::vec3(7));
  EXPECT_EQ(only<ConstantEnvironment>(s).radiance, glm::vec3(0.5f));
  EXPECT_EQ(s.shapes.at(0).radiance, glm::vec3(1, 2, 3));
}

TEST_F(MitsubaPlugins, LightErrors) {
  EXPECT_THAT(error(scene(in("emitter", "constant") + in("emitter", "constant"))),
              HasSubstr("emitter 'constant' is a second sky"));
  EXPECT_THAT(error(scene(in("emitter", "point", "<point name='position' value='1 2 3'/>" + to_world("")))),
              HasSubstr("either position or to_world"));
  EXPECT_THAT(error(scene(in("shape", "cube", in("emitter", "point")))),
              HasSubstr("cannot belong to a shape"));
  EXPECT_THAT(error(scene(in("shape", "cube", in("emitter", "area") + in("emitter", "area")))),
              HasSubstr("2 of <emitter>"));
  EXPECT_THAT(error(scene(in("emitter", "aera"))), HasSubstr("did you mean 'area'?"));
}

TEST_F(MitsubaPlugins, SpotLights) {
  const SceneDescription s =
      good(in("emitter", "spot",
              "<rgb name='intensity' value='1 2 3'/><float name='cutoffAngle' value='40'/>" +
                  std::string("<texture type='checkerboard' name='texture'/>") +
                  "<string name='falloff' value='smoothstep'/>") +
           in("emitter", "directional",
              "<rgb name='irradiance' value='3'/><vector name='direction' x='0' y='-2' z='0'/>") +
           in("emitter", "projector",
              "<texture type='checkerboard' name='irradiance'/><float name='scale' value='4'/>"));
  const SpotLight& spot = only<SpotLight>(s);
  EXPECT_EQ(spot.intensity, glm::vec3(1, 2, 3));
  EXPECT_EQ(spot.cutoff_angle, 40);
  EXPECT_EQ(spot.beam_width, 30);
  EXPECT_EQ(spot.falloff, SpotFalloff::kSmoothstep);
  EXPECT_EQ(spot.texture.texture, 0);
  EXPECT_EQ(only<DirectionalLight>(s).direction, glm::dvec3(0, -2, 0));
  EXPECT_EQ(only<DirectionalLight>(s).irradiance, glm::vec3(3));
  const ProjectorLight& projector = only<ProjectorLight>(s);
  EXPECT_EQ(projector.irradiance.texture, 1);
  EXPECT_EQ(projector.scale, 4);
  EXPECT_EQ(projector.fov_axis, FovAxis::kDiagonal);
  EXPECT_NEAR(projector.fov, 46.7930033, 1e-6);  // of a 50 mm lens
}

TEST_F(MitsubaPlugins, LampsOfASizeThatTheCameraDoesNotSee) {
  const SceneDescription s =
      good(in("emitter", "spot", "<float name='radius' value='0.25'/>") +
           in("emitter", "directional",
              "<float name='angle' value='0.5'/><boolean name='seen_by_camera' value='false'/>") +
           in("shape", "rectangle",
              in("emitter", "area",
                 "<boolean name='seen_by_camera' value='false'/><float name='spread' value='60'/>")) +
           in("shape", "rectangle", in("emitter", "area", "")));
  EXPECT_EQ(only<SpotLight>(s).radius, 0.25);
  EXPECT_EQ(only<DirectionalLight>(s).angle, 0.5);
  EXPECT_FALSE(only<DirectionalLight>(s).seen_by_camera);
  EXPECT_FALSE(s.shapes.at(0).camera_sees_emission);
  EXPECT_EQ(s.shapes.at(0).emission_spread, 60);
  EXPECT_TRUE(s.shapes.at(1).camera_sees_emission);
  EXPECT_FALSE(s.shapes.at(1).has_spread());
}

TEST_F(MitsubaPlugins, SpotLightErrors) {
  const auto wrong = [&](const char* type, const std::string& inside) {
    return error(scene(in("emitter", type, inside)));
  };
  const auto number = [](const char* name, const char* value) {
    return "<float name='" + std::string(name) + "' value='" + value + "'/>";
  };
  EXPECT_THAT(wrong("spot", number("cutoff_angle", "-10")),
              HasSubstr("cutoff_angle must be a number in (0, 180], not -10"));
  EXPECT_THAT(wrong("spot", number("cutoff_angle", "nan")), HasSubstr("nan"));
  EXPECT_THAT(wrong("spot", number("beam_width", "25")),
              HasSubstr("between 0 and the cutoff_angle 20, not 25"));
  EXPECT_THAT(wrong("spot", number("beam_width", "-1")), HasSubstr("not -1"));
  EXPECT_THAT(wrong("spot", number("cutoff_angle", "95") + "<texture type='checkerboard' name='texture'/>"),
              HasSubstr("must be below 90 degrees, not 95"));
  EXPECT_THAT(wrong("spot", "<string name='falloff' value='cubic'/>"), HasSubstr("linear"));
  EXPECT_THAT(wrong("spot", number("radius", "-0.5")),
              HasSubstr("radius must be a number from 0 on, not -0.5"));
  EXPECT_THAT(wrong("spot", number("radius", "inf")), HasSubstr("'inf' is not a finite number"));
  for (const char* angle : {"-1", "181"})
    EXPECT_THAT(wrong("directional", number("angle", angle)),
                HasSubstr("angle must be a number in [0, 180], not " + std::string(angle)));
  EXPECT_THAT(wrong("directional", "<boolean name='seen_by_camera' value='maybe'/>"), HasSubstr("maybe"));
  const auto area = [&](const char* shape, const char* spread) {
    return error(scene(in("shape", shape, in("emitter", "area", number("spread", spread)))));
  };
  for (const char* spread : {"0", "180.5"})
    EXPECT_THAT(area("rectangle", spread),
                HasSubstr("spread must be a number in [0.1, 180], not " + std::string(spread)));
  EXPECT_THAT(area("sphere", "90"), HasSubstr("only a flat shape, a mesh or a disk, has a spread below 180"));
  EXPECT_THAT(wrong("spot", "<rgb name='intensity' value='-1 0 0'/>"), HasSubstr("0 or more"));
  EXPECT_THAT(wrong("spot", to_world("<scale x='0'/>")), HasSubstr("flatten"));
  EXPECT_THAT(wrong("directional", "<vector name='direction' value='0 0 0'/>"),
              HasSubstr("the direction must have a length above 0"));
  EXPECT_THAT(wrong("directional", "<vector name='direction' value='0 0 1'/>" + to_world("")),
              HasSubstr("either direction or to_world, not both"));
  EXPECT_THAT(wrong("projector", number("fov", "180")),
              HasSubstr("fov must be a number in (0, 180), not 180"));
  EXPECT_THAT(wrong("projector", number("fov", "-5")), HasSubstr("not -5"));
  EXPECT_THAT(wrong("projector", number("fov", "50") + "<string name='focal_length' value='20mm'/>"),
              HasSubstr("either fov or focal_length, not both"));
  EXPECT_THAT(wrong("projector", "<string name='focal_length' value='far'/>"),
              HasSubstr("'far' is not a focal length"));
  EXPECT_THAT(wrong("projector", number("scale", "-1")), HasSubstr("scale must be"));
  EXPECT_THAT(
      wrong("projector",
            "<texture type='bitmap' name='irradiance'><string name='filename' value='gone.png'/></texture>"),
      HasSubstr("no file 'gone.png'"));
  EXPECT_THAT(error(scene(in("shape", "cube", in("emitter", "spot")))),
              HasSubstr("cannot belong to a shape"));
}

TEST_F(MitsubaPlugins, TexturedAreaLights) {
  const SceneDescription s =
      good(in("shape", "rectangle", in("emitter", "area", "<texture type='checkerboard' name='radiance'/>")) +
           in("shape", "rectangle", in("emitter", "area")));
  EXPECT_EQ(s.shapes.at(0).radiance, glm::vec3(1));
  EXPECT_EQ(s.shapes.at(0).radiance_texture, 0);
  EXPECT_EQ(s.shapes.at(1).radiance_texture, kNoTexture);
}

}  // namespace
}  // namespace penumbra
