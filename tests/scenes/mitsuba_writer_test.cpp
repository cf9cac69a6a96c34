// Scenes that are written and read again give the same records for the kernels.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/settings.h"
#include "tests/scenes/scene_text.h"
#include "tests/support/every_curve.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/written_scene.h"

namespace penumbra {
namespace {

class MitsubaWriter : public SceneText {
 protected:
  SceneDescription again(const SceneDescription& scene) {
    const auto written = write_scene(scene, folder_ / "written.xml");
    EXPECT_TRUE(written) << written.error().message;
    auto read = read_scene(folder_ / "written.xml", {});
    EXPECT_TRUE(read) << read.error().message;
    return read ? std::move(*read) : SceneDescription{};
  }

  static DeviceScene device(const SceneDescription& scene) {
    auto built = build_device_scene(scene, {});
    EXPECT_TRUE(built) << built.error().message;
    return built ? std::move(*built) : DeviceScene{};
  }

  /// To the bit: cameras, settings and tables.
  void expect_same(const SceneDescription& scene) {
    const DeviceScene before = device(scene), after = device(again(scene));
    EXPECT_EQ(std::memcmp(&before.header, &after.header, sizeof(SceneHeader)), 0);
    ASSERT_EQ(before.words.size(), after.words.size());
    const auto differ = std::ranges::mismatch(before.words, after.words).in1 - before.words.begin();
    for (const SceneTable& each : kSceneTables) {
      const TableSpan span = before.header.tables.*each.span;
      const int words = std::max(span.count, each.least) * each.record_bytes / 4, first = int(span.offset);
      EXPECT_FALSE(differ >= first && differ < first + words)
          << each.what << " differ in record " << (differ - first) / (each.record_bytes / 4) << ", word "
          << (differ - first) % (each.record_bytes / 4);
    }
    EXPECT_EQ(std::size_t(differ), before.words.size());
  }

  /// A scene of one ball of that BSDF, and a light.
  void expect_same_bsdf(const std::string& bsdf) {
    SCOPED_TRACE(bsdf);
    expect_same(good("<shape type='sphere'><point name='center' x='1' y='2' z='3'/>" + bsdf +
                     "</shape><shape type='rectangle'><emitter type='area'><rgb name='radiance' "
                     "value='1, 2, 3'/></emitter></shape>"));
  }
};

std::string diffuse(const std::string& colour) {
  return "<bsdf type='diffuse'><rgb name='reflectance' value='" + colour + "'/></bsdf>";
}

TEST_F(MitsubaWriter, SampleScenesStayTheSame) {
  const std::filesystem::path scenes = PENUMBRA_SOURCE_DIR "/scenes";
  for (const char* file :
       {"cornell/cornell.xml", "cornell-small/cornell-small.xml", "veach-mis/veach-mis.xml",
        "materials/materials.xml", "star-light/star-light.xml", "furnace/furnace.xml",
        "furnace/unit-sphere.xml", "polygon-lights/polygon-lights.xml"}) {
    SCOPED_TRACE(file);
    const auto scene = read_scene(scenes / file, {});
    ASSERT_TRUE(scene) << scene.error().message;
    expect_same(*scene);
  }
}

TEST_F(MitsubaWriter, LayersStayTheSame) {
  const SceneDescription scene = good(
      "<integrator type='aov'><string name='aovs' value='i:shape_index, p:position, u:uv, n:geo_normal'/>"
      "<integrator type='direct'/></integrator><shape type='sphere'/>");
  EXPECT_EQ(scene.film.layers.size(), 4u);
  expect_same(scene);
}

TEST_F(MitsubaWriter, BsdfsStayTheSame) {
  const std::string board =
      "<texture type='checkerboard'><rgb name='color0' value='0.1, 0.2, 0.3'/><transform name='to_uv'><scale "
      "x='3' y='5'/><rotate z='1' angle='30'/></transform></texture>";
  const std::string red = diffuse("0.7, 0.2, 0.1"), blue = diffuse("0.1, 0.2, 0.7");
  const auto in_bsdf = [](const std::string& type, const std::string& inside) {
    return "<bsdf type='" + type + "'>" + inside + "</bsdf>";
  };
  const std::string coated = in_bsdf("openpbr", "<float name='coat_weight' value='1'/>"),
                    base = "<string name='layers' value='base'/>",
                    coat = "<string name='layers' value='coat'/>";
  for (const std::string& bsdf :
       {red,
        in_bsdf("twosided", red),
        in_bsdf("twosided", red + blue),
        in_bsdf("dielectric", ""),
        in_bsdf("dielectric", "<string name='int_ior' value='diamond'/>"),
        in_bsdf("thindielectric", "<float name='int_ior' value='1.7'/>"),
        in_bsdf("roughdielectric", "<float name='alpha' value='0.3'/>"),
        in_bsdf("conductor", "<string name='material' value='Au'/>"),
        in_bsdf("conductor", "<string name='material' value='none'/>"),
        in_bsdf("conductor", ""),
        in_bsdf("roughconductor", "<float name='alpha_u' value='0.3'/><float name='alpha_v' value='0.1'/>"),
        in_bsdf("roughconductor",
                "<float name='alpha' value='0.25'/><string name='distribution' "
                "value='ggx'/><rgb name='eta' value='1,2,3'/><rgb name='k' value='3,4,5'/>"),
        in_bsdf("plastic", "<boolean name='nonlinear' value='true'/>"),
        in_bsdf("roughplastic", "<float name='alpha' value='0.2'/>"),
        in_bsdf("principled", "<float name='roughness' value='0.4'/><float name='specular' value='0.7'/>"),
        in_bsdf("principled", "<float name='spec_trans' value='0.5'/><float name='eta' value='1.3'/>"),
        in_bsdf("principledthin", "<float name='spec_trans' value='0.5'/>"),
        in_bsdf("hair", ""),
        in_bsdf("hair", "<float name='pheomelanin' value='0.7'/><float name='scale_tilt' value='3'/>"),
        in_bsdf("hair", "<rgb name='sigma_a' value='0'/><float name='longitudinal_roughness' value='0.2'/>"),
        in_bsdf("hair", "<rgb name='reflectance' value='0.5'/><string name='offset' value='v'/>"),
        in_bsdf("null", ""),
        in_bsdf("mask", "<float name='opacity' value='0.3'/>" + red),
        in_bsdf("mask", in_bsdf("twosided", red + blue)),
        in_bsdf("blendbsdf", "<float name='weight' value='0.3'/>" + red + in_bsdf("dielectric", "")),
        in_bsdf("blendbsdf", in_bsdf("null", "") + in_bsdf("mask", blue)),
        in_bsdf("diffuse", "<texture name='reflectance' " + board.substr(9)),
        in_bsdf("bumpmap", board + "<float name='scale' value='0.4'/>" + in_bsdf("twosided", red)),
        in_bsdf("twosided", in_bsdf("normalmap", board + red)),
        in_bsdf("bumpmap", board + in_bsdf("roughdielectric", "")),
        in_bsdf("normalmap", board + base + coated),
        in_bsdf("bumpmap", board + coat + coated),
        in_bsdf("normalmap", board + coat + in_bsdf("bumpmap", board + base + in_bsdf("twosided", coated))),
        in_bsdf("twosided", in_bsdf("bumpmap", board + coat + in_bsdf("normalmap", board + base + coated)))})
    expect_same_bsdf(bsdf);
}

TEST_F(MitsubaWriter, LightsCylindersAndInstancesStayTheSame) {
  const std::string frame =
      "<transform name='to_world'><rotate y='1' angle='30'/><translate x='2'/></transform>";
  for (const std::string& text :
       {"<shape type='cylinder'><point name='p0' x='1' y='2' z='3'/><point name='p1' x='1' y='2' z='7'/>"
        "<float name='radius' value='0.5'/>" +
            diffuse("0.1, 0.2, 0.3") + "</shape><emitter type='constant'/>",
        "<shape type='shapegroup' id='inner'><shape type='sphere'>" + diffuse("0.7, 0.2, 0.1") +
            "</shape></shape><shape type='instance'><ref id='inner'/>" + frame +
            "</shape><emitter type='directional'><vector name='direction' x='1' y='-1' z='2'/></emitter>",
        "<shape type='sphere'/><emitter type='directional'>" + frame + "</emitter><emitter type='point'>" +
            frame + "</emitter>",
        "<shape type='sphere'/><emitter type='spot'><float name='cutoff_angle' value='40'/><string "
        "name='falloff' value='squared'/>" +
            frame + "</emitter>",
        "<shape type='rectangle'><emitter type='area'><boolean name='seen_by_camera' "
        "value='false'/><float name='spread' value='60'/></emitter>"
        "</shape><emitter type='spot'><float name='radius' value='0.25'/>" +
            frame +
            "</emitter><emitter type='directional'><float name='angle' value='0.5'/><boolean "
            "name='seen_by_camera' value='false'/></emitter>",
        std::string(
            "<shape type='rectangle'><emitter type='area'><texture type='checkerboard' name='radiance'><rgb "
            "name='color0' value='1, 2, 3'/><rgb name='color1' value='0.5'/></texture></emitter></shape>")}) {
    SCOPED_TRACE(text);
    expect_same(good(text));
  }
}

TEST_F(MitsubaWriter, CurvesStayTheSame) {
  SceneDescription scene = good("<emitter type='constant'/><shape type='sphere'><bsdf type='twosided'>" +
                                diffuse("0.5, 0.4, 0.3") + "</bsdf></shape>");
  add_every_curve(scene, {0.1, 0.2, 0.3}, 2);
  // Materials are numbered as they are met.
  const SceneDescription read = again(scene);
  expect_same(read);
  const DeviceScene before = device(scene), after = device(read);
  const auto first = table<Quadric>(before, before.header.tables.quadrics),
             second = table<Quadric>(after, after.header.tables.quadrics);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    Quadric there = second[i];
    there.front = first[i].front;
    there.back = first[i].back;
    EXPECT_EQ(std::memcmp(&first[i], &there, sizeof there), 0) << i;
  }
}

TEST_F(MitsubaWriter, InstancesWithinGroupsAreWrittenAsTheScenesOwn) {
  const auto instance = [](const std::string& id, const std::string& steps) {
    return "<shape type='instance'><ref id='" + id + "'/><transform name='to_world'>" + steps +
           "</transform></shape>";
  };
  const SceneDescription scene =
      good("<shape type='shapegroup' id='inner'><shape type='sphere'>" + diffuse("0.7, 0.2, 0.1") +
           "</shape></shape><shape type='shapegroup' id='outer'>" + instance("inner", "<translate x='2'/>") +
           instance("inner", "<scale value='0.5'/>") + "</shape>" +
           instance("outer", "<rotate y='1' angle='90'/>") + instance("inner", "<translate y='4'/>") +
           "<emitter type='constant'/>");
  expect_same(scene);
  const SceneDescription written = again(scene);
  EXPECT_EQ(written.instances.size(), 3u);
  for (const ShapeGroup& group : written.groups) EXPECT_TRUE(group.instances.empty());
}

TEST_F(MitsubaWriter, EmittingShapesOfGroupsAreWrittenInEachOfTheirPlaces) {
  const auto instance = [](const std::string& id, const std::string& steps) {
    return "<shape type='instance'><ref id='" + id + "'/><transform name='to_world'>" + steps +
           "</transform></shape>";
  };
  const std::string light = "<emitter type='area'><rgb name='radiance' value='1, 2, 3'/></emitter>";
  const std::string small = "<transform name='to_world'><scale value='0.25'/></transform>";
  // Within the others of its group, which so stay where they are.
  const SceneDescription scene = good(
      "<shape type='shapegroup' id='area_light'><shape type='cube'>" + diffuse("0.7, 0.2, 0.1") +
      "</shape><shape type='rectangle'>" + small + light + diffuse("0.2, 0.2, 0.2") +
      "</shape><shape type='disk'>" + small + light +
      "</shape></shape><shape type='shapegroup' id='bulb'><shape type='sphere'>" + small + light +
      "</shape></shape><shape type='shapegroup' id='street'>" + instance("area_light", "<translate x='2'/>") +
      instance("bulb", "<translate z='-2'/>") + "</shape>" + instance("street", "<translate y='4'/>") +
      instance("area_light", "<scale x='-2' y='2' z='2'/>"));
  expect_same(scene);
  const SceneDescription written = again(scene);
  EXPECT_EQ(written.shapes.size(), 5u);
  EXPECT_EQ(written.groups.size(), 1u);
  EXPECT_EQ(written.instances.size(), 2u);
  for (const Shape& shape : written.shapes) EXPECT_TRUE(shape.radiance);
  for (const ShapeGroup& group : written.groups)
    for (const Shape& shape : group.shapes) EXPECT_FALSE(shape.radiance);
}

TEST_F(MitsubaWriter, BlackEmittersOfGroupsAreSurfacesOfTheirGroup) {
  // Under an instance that makes an ellipsoid of a ball, where no light could be.
  const auto scene = [&](const std::string& bsdf) {
    return good("<shape type='shapegroup' id='g'><shape type='sphere'>" + bsdf +
                "<emitter type='area'><rgb name='radiance' value='0'/></emitter></shape></shape><shape "
                "type='instance'><ref id='g'/><transform name='to_world'><scale x='2' y='3' "
                "z='1'/></transform></shape>"
                "<emitter type='point'/>");
  };
  expect_same(scene(diffuse("0.3")));
  // Without a BSDF it is black, which a shape that is no emitter says by one that reflects nothing.
  const SceneDescription black = again(scene(""));
  ASSERT_EQ(black.groups.size(), 1u);
  const Shape& shape = black.groups[0].shapes.at(0);
  EXPECT_FALSE(shape.radiance);
  const auto& bsdf = std::get<DiffuseBsdf>(black.bsdfs.at(std::size_t(shape.front_bsdf)).model);
  EXPECT_EQ(bsdf.reflectance.value, glm::vec3(0.0f));
}

TEST_F(MitsubaWriter, PhotonMapsStayTheSame) {
  const auto same = [&](const IntegratorMethod& method) {
    SceneDescription scene = good(
        "<shape type='sphere'/><shape type='rectangle'><emitter type='area'><rgb name='radiance' "
        "value='1, 2, 3'/></emitter></shape>");
    scene.integrator.method = method;
    scene.integrator.hide_emitters = true;
    scene.integrator.hidden_emitters = HiddenEmitters::kLookedThrough;
    expect_same(scene);
    const SceneDescription written = again(scene);
    for (const Setting& setting : all_settings())
      if (setting.key.starts_with("integrator.") && setting.belongs_to(scene))
        EXPECT_EQ(setting.print(written), setting.print(scene)) << setting.key;
  };
  same(PhotonMapIntegrator{});
  same(PhotonMapIntegrator{.max_depth = 9,
                           .rr_depth = 7,
                           .global_photons = 1000,
                           .caustic_photons = 0,
                           .volume_photons = 3000,
                           .global_lookup_radius = 0.1f,
                           .caustic_lookup_radius = 0.2f,
                           .volume_lookup_radius = 0.3f,
                           .photon_radius = 0.25f,
                           .lookup_size = 60,
                           .final_gather = true,
                           .emitter_sampling = EmitterSampling::kArea,
                           .heuristic = MisHeuristic::kPower,
                           .light_choice = LightChoice::kPower});
  same(ProgressivePhotonIntegrator{});
  for (const std::optional<float> alpha : {std::optional<float>(0.5f), std::optional<float>()})
    same(ProgressivePhotonIntegrator{
        .max_depth = 9, .rr_depth = 7, .photon_count = 1000, .initial_radius = 0.25f, .alpha = alpha});
}

TEST_F(MitsubaWriter, WhatMitsubasIntegratorsHaveNoNameForIsLeftOut) {
  const SceneDescription written = again(good(
      "<integrator type='path'><string name='emitter_sampling' value='area'/><string name='light_choice' "
      "value='power'/><integer name='max_depth' value='3'/></integrator><shape type='sphere'/>"));
  EXPECT_EQ(param::max_depth(written.integrator), 3);
  EXPECT_EQ(param::emitter_sampling(written.integrator), EmitterSampling::kAuto);
  const SceneDescription own =
      again(good("<integrator type='whitted'><string name='light_choice' value='power'/>"
                 "</integrator><shape type='sphere'/>"));
  EXPECT_EQ(param::light_choice(own.integrator), LightChoice::kPower);
}

TEST_F(MitsubaWriter, CamerasAndSettingsStayTheSame) {
  for (const char* text :
       {"<sensor type='perspective'><string name='focal_length' value='35mm'/><transform "
        "name='to_world'><scale x='-1'/><lookat origin='1,2,3' target='0,0,1' "
        "up='0,1,0'/></transform></sensor>",
        "<sensor type='thinlens'><float name='fov' value='33'/><float name='aperture_radius' "
        "value='0.1'/><integer name='blades' value='6'/><float name='refocus_red' value='0.1'/><float "
        "name='distortion_k1' value='-0.01'/><film type='hdrfilm'><integer name='width' value='99'/><integer "
        "name='crop_width' value='40'/><rfilter type='tent'><float name='radius' "
        "value='1.5'/></rfilter></film>"
        "<sampler type='independent'><integer name='seed' value='9'/></sampler></sensor>",
        "<sensor type='orthographic'><transform name='to_world'><scale x='2' y='3' z='4'/><translate "
        "x='5'/></transform><float name='near_clip' value='0.5'/></sensor>"})
    expect_same(good(std::string(text) +
                     "<integrator type='path'><integer name='max_depth' value='7'/><boolean "
                     "name='hide_emitters' value='true'/></integrator><shape type='cube'/><emitter "
                     "type='point'><point name='position' value='1,2,3'/></emitter>"));
}

TEST_F(MitsubaWriter, PanoramasStayTheSameAndAreNoneOfMitsubas) {
  for (const auto& [type, parameters] :
       {std::pair("equirectangular",
                  "<float name='longitude_min' value='-20'/><float name='longitude_max' value='300'/><float "
                  "name='latitude_min' value='-45'/><float name='latitude_max' value='80'/><string "
                  "name='stereo' value='top_bottom'/><float name='interocular_distance' value='0.1'/>"),
        {"cylindrical",
         "<float name='longitude_min' value='-90'/><float name='height_min' value='-2'/><float "
         "name='height_max' value='0.5'/><float name='near_clip' value='0.5'/>"},
        {"fisheye_equidistant",
         "<float name='fisheye_fov' value='270'/><string name='fov_axis' value='smaller'/><float "
         "name='principal_point_offset_x' value='0.1'/>"},
        {"fisheye_equisolid",
         "<float name='fisheye_fov' value='200'/><float name='fisheye_lens' value='8'/><float "
         "name='sensor_width' value='24'/><float name='aperture_radius' value='0.1'/><float "
         "name='focus_distance' value='3'/><integer name='blades' value='5'/>"},
        {"equal_area", "<transform name='to_world'><translate x='4'/></transform>"}}) {
    SCOPED_TRACE(type);
    const SceneDescription scene =
        good(std::string("<sensor type='") + type + "'>" + parameters + "</sensor><shape type='cube'/>");
    EXPECT_EQ(projection_name(scene.camera.projection), type);
    expect_same(scene);
    std::vector<std::string> refused;
    ASSERT_TRUE(mitsuba::scene_files(scene, folder_ / "written.xml", &refused));
    EXPECT_THAT(refused, testing::Contains(std::string("Mitsuba 3 has no sensor '") + type + "'"));
  }
}

}  // namespace
}  // namespace penumbra
