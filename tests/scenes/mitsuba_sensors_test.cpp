// Conversion of Mitsuba's cameras, films and samplers.
#include <cmath>
#include <numbers>

#include "tests/scenes/mitsuba_text.h"

namespace penumbra {
namespace {

TEST_F(MitsubaPlugins, FieldsOfView) {
  const CameraSettings standard = good(in("sensor", "perspective")).camera;
  EXPECT_EQ(standard.fov_axis, FovAxis::kDiagonal);
  EXPECT_NEAR(standard.fov, 46.7930033, 1e-6);  // of a 50 mm lens
  const CameraSettings wide =
      good(in("sensor", "perspective", "<string name='focal_length' value='35mm'/>")).camera;
  EXPECT_NEAR(std::tan(wide.fov * std::numbers::pi / 360.0), std::hypot(36.0, 24.0) / 70.0, 1e-12);
  const std::pair<const char*, FovAxis> axes[] = {{"x", FovAxis::kX},
                                                  {"y", FovAxis::kY},
                                                  {"diagonal", FovAxis::kDiagonal},
                                                  {"smaller", FovAxis::kSmaller},
                                                  {"larger", FovAxis::kLarger}};
  for (const auto& [name, axis] : axes) {
    const CameraSettings camera = good(in("sensor", "perspective",
                                          "<float name='fov' value='1e-6'/><string name='fov_axis' value='" +
                                              std::string(name) + "'/>"))
                                      .camera;
    EXPECT_EQ(camera.fov_axis, axis);
    EXPECT_EQ(camera.fov, 1e-6);
  }
  EXPECT_EQ(good(in("sensor", "perspective", "<integer name='fov' value='40'/>")).camera.fov_axis,
            FovAxis::kX);
}

TEST_F(MitsubaPlugins, CameraFrames) {
  const CameraSettings camera =
      good(in("sensor", "perspective",
              to_world("<scale value='1 2 3'/><lookat origin='1 2 3' target='1 2 9' up='0 1 0'/>")))
          .camera;
  EXPECT_EQ(camera.to_world, glm::dmat4({1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {1, 2, 3, 1}));
  const CameraSettings mirrored = good(in("sensor", "perspective", to_world("<scale x='-2'/>"))).camera;
  EXPECT_EQ(mirrored.to_world[0], glm::dvec4(-1, 0, 0, 0));
}

TEST_F(MitsubaPlugins, CameraErrors) {
  const auto message = [&](std::string_view inside) {
    return error(scene(in("sensor", "perspective", inside)));
  };
  EXPECT_THAT(message("<float name='fov' value='180'/>"), HasSubstr("fov: 180 is not above 0 and below 180"));
  EXPECT_THAT(message("<float name='fov' value='0'/>"), HasSubstr("fov: 0 is not above 0"));
  EXPECT_THAT(message("<float name='fov' value='50'/><string name='focal_length' value='50mm'/>"),
              HasSubstr("not both"));
  EXPECT_THAT(message("<string name='focal_length' value='50in'/>"),
              HasSubstr("not a focal length such as 50mm"));
  EXPECT_THAT(message("<string name='fov_axis' value='x'/>"), HasSubstr("fov_axis needs a fov"));
  EXPECT_THAT(message("<float name='fov' value='50'/><string name='fov_axis' value='xy'/>"),
              HasSubstr("not one of: x, y"));
  EXPECT_THAT(message("<float name='principal_point_offset_x' value='1e9'/>"), HasSubstr("-1000"));
  EXPECT_THAT(message("<float name='aperture_radius' value='1'/>"), HasSubstr("no parameter 'aperture_rad"));
  EXPECT_THAT(message(to_world("<matrix value='1 0 0 0 nan 0 0 0 1'/>")), HasSubstr("nan"));
  EXPECT_THAT(message(to_world("<scale x='0'/>")), HasSubstr("singular"));
  EXPECT_THAT(message("<float name='fov' value='60'/><float name='distortion_k1' value='-2'/>"),
              HasSubstr("folds the image over: it grows up to r = 0.408248"));
  EXPECT_THAT(message("<float name='near_clip' value='5'/><float name='far_clip' value='4'/>"),
              HasSubstr("must be less than"));
  EXPECT_THAT(message(to_world("<matrix value='1 1 0 0 1 0 0 0 1'/>")), HasSubstr("shears"));
  EXPECT_THAT(error("<scene version='3.0.0'/>"), HasSubstr("the scene has no <sensor>, and no shapes"));
}

TEST_F(MitsubaPlugins, WithoutASensorOneSeesAllShapes) {
  const SceneDescription result = good_of(
      read("<scene version='0.6.0'><shape type='sphere'><point name='center' x='1' y='2' z='3'/></shape>"
           "<shape type='sphere'><point name='center' x='1' y='6' z='4'/></shape></scene>"));
  EXPECT_THAT(warnings(result), HasSubstr("no <sensor>"));
  // The box is [0, 2] x [1, 7] x [2, 5]: its largest extent fills 45 degrees at its front.
  const double distance = 3 / std::tan(22.5 * std::numbers::pi / 180);
  const glm::dvec4 at = result.camera.to_world[3];
  EXPECT_NEAR(glm::length(glm::dvec3(at) - glm::dvec3(1, 4, 2 - distance)), 0, 1e-12);
  EXPECT_EQ(result.camera.to_world[2], glm::dvec4(0, 0, 1, 0));
  EXPECT_EQ(result.camera.fov, 45);
  EXPECT_NEAR(result.camera.far_clip, 30 + distance, 1e-12);
  EXPECT_THAT(
      error("<scene version='3.0.0'>" + in("shape", "sphere", in("sensor", "irradiancemeter")) + "</scene>"),
      HasSubstr("sensors of shapes are not read"));
}

TEST_F(MitsubaPlugins, Lenses) {
  const auto lens = [&](std::string_view inside, std::string_view type = "thinlens") {
    return in("sensor", type, inside);
  };
  const auto message = [&](std::string_view inside) { return error(scene(lens(inside))); };
  const std::string radius = "<float name='aperture_radius' value='0.2'/>";
  const CameraSettings open = good(lens(radius + "<float name='focus_distance' value='3'/>")).camera;
  EXPECT_EQ(open.aperture_radius, 0.2);
  EXPECT_EQ(open.focus_distance, 3);
  EXPECT_EQ(open.projection, Projection::kPerspective);
  const CameraSettings far = good(lens(radius + "<float name='far_clip' value='77'/>")).camera;
  EXPECT_EQ(far.focus_distance, 77) << "Mitsuba's default";
  const CameraSettings bladed = good(lens(radius + "<integer name='blades' value='5'/><float "
                                                   "name='blade_rotation' value='-30'/>"))
                                    .camera;
  EXPECT_EQ(bladed.blades, 5);
  EXPECT_EQ(bladed.blade_rotation, -30);
  EXPECT_THAT(message(""), HasSubstr("needs an aperture_radius"));
  EXPECT_THAT(message("<float name='aperture_radius' value='-0.1'/>"), HasSubstr("-0.1 is not"));
  EXPECT_THAT(message("<float name='aperture_radius' value='nan'/>"), HasSubstr("nan"));
  EXPECT_THAT(message(radius + "<float name='focus_distance' value='0'/>"), HasSubstr("0 is not above 0"));
  EXPECT_THAT(message(radius + "<integer name='blades' value='2'/>"), HasSubstr("no 2 blades"));
  EXPECT_THAT(message(radius + "<float name='refocus_red' value='-1'/>"), HasSubstr("-1 is not above -1"));
  EXPECT_THAT(good(lens("<float name='aperture_radius' value='0'/>")).warnings,
              ::testing::ElementsAre(HasSubstr("it is a pinhole")));
  const CameraSettings both = good(lens(radius, "telecentric")).camera;
  EXPECT_EQ(both.projection, Projection::kOrthographic);
  EXPECT_EQ(both.aperture_radius, 0.2);
}

TEST_F(MitsubaPlugins, OrthographicAndDistortedCameras) {
  const CameraSettings flat =
      good(in("sensor", "orthographic",
              to_world("<scale x='-2' y='3' z='4'/><translate x='5'/>") +
                  "<float name='near_clip' value='0.5'/><float name='far_clip' value='20'/>"))
          .camera;
  EXPECT_EQ(flat.projection, Projection::kOrthographic);
  EXPECT_EQ(flat.to_world, glm::dmat4({-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {5, 0, 0, 1}));
  EXPECT_EQ(flat.scale_x, 2);
  EXPECT_EQ(flat.scale_y, 3);
  EXPECT_EQ(flat.near_clip, 2) << "Mitsuba's near plane takes part in the scale";
  EXPECT_EQ(flat.far_clip, 21.5) << "... and the far one is as far from it as without";
  EXPECT_THAT(error(scene(in("sensor", "orthographic", "<float name='fov' value='30'/>"))),
              HasSubstr("no parameter 'fov'"));
  const auto distorted = [&](std::string_view kc) {
    return in("sensor", "perspective_rdist", "<string name='kc' value='" + std::string(kc) + "'/>");
  };
  EXPECT_EQ(good(distorted("-0.1, 0.05")).camera.distortion_k1, -0.1);
  EXPECT_EQ(good(distorted("-0.1, 0.05")).camera.distortion_k2, 0.05);
  EXPECT_THAT(error(scene(distorted("0.1"))), HasSubstr("not two numbers, k1 and k2"));
  EXPECT_THAT(good(in("sensor", "perspective",
                      "<float name='shutter_open' value='0'/><float name='shutter_close' value='0.1'/>"))
                  .warnings,
              ::testing::IsEmpty());
  EXPECT_THAT(
      error(scene(in("sensor", "perspective",
                     "<float name='shutter_open' value='1'/><float name='shutter_close' value='0.5'/>"))),
      HasSubstr("closes at 0.5; it opens at 1"));
  EXPECT_THAT(good(in("sensor", "perspective", "<string name='rolling_shutter_type' value='top'/>")).warnings,
              ::testing::ElementsAre(HasSubstr("rolling_shutter delays")));
  const CameraSettings named = good(in("sensor", "perspective",
                                       "<string name='shutter_curve' value='0 1 1'/><float name='shutter' "
                                       "value='0.5'/><float name='rolling_shutter' value='0.25'/><string "
                                       "name='shutter_position' value='end'/>"))
                                   .camera;
  EXPECT_EQ(named.shutter, 0.5f);
  EXPECT_EQ(named.shutter_position, ShutterPosition::kEnd);
  EXPECT_EQ(named.shutter_curve, (std::vector{0.0, 1.0, 1.0}));
  EXPECT_EQ(named.rolling_shutter, 0.25);
}

TEST_F(MitsubaPlugins, Films) {
  const auto film = [&](std::string_view inside) {
    return good(in("sensor", "perspective", in("film", "hdrfilm", inside))).film;
  };
  EXPECT_EQ(film("").width, 768);
  EXPECT_EQ(film("").filter, FilterKind::kGaussian);
  const Film sized = film("<integer name='width' value='1'/><integer name='height' value='1'/>");
  EXPECT_EQ(sized.crop_width, 1);
  EXPECT_EQ(sized.crop_height, 1);
  EXPECT_EQ(film(in("rfilter", "box")).filter_radius, 0.5f);
  EXPECT_EQ(film(in("rfilter", "tent")).filter_radius, 1.0f);
  EXPECT_EQ(film(in("rfilter", "tent", "<float name='radius' value='1.5'/>")).filter_radius, 1.5f);
  EXPECT_EQ(film(in("rfilter", "gaussian", "<float name='stddev' value='.25'/>")).filter_radius, 1.0f);
  const Film mitchell =
      film(in("rfilter", "mitchell", "<float name='B' value='0'/><float name='C' value='.5'/>"));
  EXPECT_EQ(mitchell.filter, FilterKind::kMitchell);
  EXPECT_EQ(mitchell.filter_b, 0.0f);
  EXPECT_EQ(mitchell.filter_c, 0.5f);
  good(in("sensor", "perspective",
          in("film", "ldrfilm", "<float name='gamma' value='2.2'/><boolean name='banner' value='false'/>")));
}

TEST_F(MitsubaPlugins, FilmErrors) {
  const auto message = [&](std::string_view inside) {
    return error(scene(in("sensor", "perspective", in("film", "hdrfilm", inside))));
  };
  EXPECT_THAT(message("<integer name='width' value='1000000'/>"),
              HasSubstr("width: '1000000' is not in the range from 1 to 65536"));
  EXPECT_THAT(message("<float name='width' value='10'/>"), HasSubstr("must be a <integer>, not a <float>"));
  EXPECT_THAT(message("<integer name='width' value='65536'/><integer name='height' value='65536'/>"),
              HasSubstr("too large"));
  EXPECT_THAT(message("<integer name='crop_offset_x' value='1'/>"), HasSubstr("is not inside the film"));
  EXPECT_THAT(message(in("rfilter", "welch")), HasSubstr("rfilter type 'welch' is not one"));
  EXPECT_THAT(message(in("rfilter", "box", "<float name='stddev' value='1'/>")),
              HasSubstr("rfilter 'box' has no parameter 'stddev'"));
  EXPECT_THAT(error(scene(in("sensor", "perspective", in("film", "hdrfilm") + in("film", "hdrfilm")))),
              HasSubstr("2 of <film>"));
  EXPECT_THAT(error(scene(in("sensor", "perspective", in("sampler", "sobol") + in("sampler", "sobol")))),
              HasSubstr("2 of <sampler>"));
}

TEST_F(MitsubaPlugins, Samplers) {
  const std::pair<const char*, SamplerKind> kinds[] = {
      {"independent", SamplerKind::kIndependent}, {"stratified", SamplerKind::kStratified},
      {"multijitter", SamplerKind::kStratified},  {"halton", SamplerKind::kHalton},
      {"hammersley", SamplerKind::kHalton},       {"ldsampler", SamplerKind::kSobol},
      {"orthogonal", SamplerKind::kSobol},        {"sobol", SamplerKind::kSobol}};
  for (const auto& [name, kind] : kinds) {
    const SamplerSettings sampler =
        good(in("sensor", "perspective",
                in("sampler", name,
                   "<integer name='sample_count' value='5'/><integer name='seed' value='6'/>")))
            .sampler;
    EXPECT_EQ(sampler.kind, kind) << name;
    EXPECT_EQ(sampler.spp, 5u);
    EXPECT_EQ(sampler.seed, 6u);
  }
  EXPECT_EQ(good(in("sensor", "perspective")).sampler.kind, SamplerKind::kSobol);
  EXPECT_THAT(error(scene(in("sensor", "perspective",
                             in("sampler", "sobol", "<integer name='sample_count' value='0'/>")))),
              HasSubstr("from 1 to 2147483648"));
}

}  // namespace
}  // namespace penumbra
