// Options of meshes, attributes of PLY files, skies of two emitters, and unusual materials of public scenes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenes/mesh_tools.h"
#include "tests/scenes/scene_text.h"

namespace penumbra::mitsuba_shapes_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class MitsubaShapes : public SceneText {
 protected:
  const Mesh& mesh(const SceneDescription& s) { return std::get<Mesh>(s.shapes.at(0).geometry); }
  static std::string shape(const std::string& type, const std::string& file, const std::string& inside = "") {
    return "<shape type='" + type + "'><string name='filename' value='" + file + "'/>" + inside + "</shape>";
  }
  static std::string showing(const std::string& attribute) {
    return "<bsdf type='diffuse'><texture type='mesh_attribute' name='reflectance'><string name='name' "
           "value='" +
           attribute + "'/></texture></bsdf>";
  }
};

/// A roof of two squares that share an edge along x, each sloping by `degrees` from it: the first two faces
/// are one, the others the other.
std::string roof(double degrees) {
  const double a = degrees * std::numbers::pi / 180, y = std::cos(a), z = -std::sin(a);
  return fmt::format(
      "v 0 0 0\nv 1 0 0\nv 1 {0} {1}\nv 0 {0} {1}\nv 0 -{0} {1}\nv 1 -{0} {1}\nf 1 2 3\nf 1 3 4\nf 1 5 6\nf "
      "1 6 2\n",
      y, z);
}

TEST_F(MitsubaShapes, FacesThatMeetAtMoreThanTheAngleHaveAnEdge) {
  write("a.obj", roof(20));  // 40 degrees apart
  const auto normals = [&](const std::string& angle) {
    return mesh(good(shape("obj", "a.obj", "<float name='maxSmoothAngle' value='" + angle + "'/>")));
  };
  const Mesh smooth = normals("41");
  ASSERT_THAT(smooth.positions, SizeIs(6));
  ASSERT_THAT(smooth.normals, SizeIs(6));
  const glm::vec3 up(0, 0, 1);
  for (std::size_t i = 0; i < 6; ++i) {
    const bool ridge = smooth.positions[i].y == 0;
    EXPECT_NEAR(glm::dot(smooth.normals[i], up), ridge ? 1.0 : std::cos(20 * std::numbers::pi / 180), 1e-6);
  }
  const Mesh sharp = normals("39");
  EXPECT_THAT(sharp.normals, IsEmpty()) << "all of them are the faces' own";
  EXPECT_EQ(sharp.triangles.size(), 4u);
  EXPECT_FALSE(mesh(good(shape("obj", "a.obj"))).normals.empty()) << "smooth without the parameter";
}

TEST_F(MitsubaShapes, SmoothingSplitsVerticesAlongEdgesAlone) {
  // Three squares: the first two 10 degrees apart, the third 60 degrees from the second.
  Mesh mesh;
  double y = 0, z = 0;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}};
  for (const double slope : {0.0, 10.0, 70.0}) {
    y += std::cos(slope * std::numbers::pi / 180);
    z -= std::sin(slope * std::numbers::pi / 180);
    mesh.positions.emplace_back(0, y, z);
    mesh.positions.emplace_back(1, y, z);
    const auto n = std::uint32_t(mesh.positions.size());
    mesh.triangles.emplace_back(n - 4, n - 3, n - 1);
    mesh.triangles.emplace_back(n - 4, n - 1, n - 2);
  }
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) mesh.texcoords.emplace_back(float(i), 0.0f);
  smooth_up_to(mesh, 30);
  EXPECT_THAT(mesh.positions, SizeIs(10)) << "the two of the edge twice";
  ASSERT_THAT(mesh.normals, SizeIs(10));
  ASSERT_THAT(mesh.texcoords, SizeIs(10));
  EXPECT_THAT(mesh.triangles, SizeIs(6));
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    const bool first_edge = mesh.texcoords[i].x == 2 || mesh.texcoords[i].x == 3;
    EXPECT_NEAR(glm::length(mesh.normals[i]), 1, 1e-6);
    // (0, sin, cos) of a slope: between the first two squares the mean of theirs, as both corners weigh
    // alike.
    if (first_edge) {
      EXPECT_NEAR(mesh.normals[i].y, std::sin(5 * std::numbers::pi / 180), 1e-6);
    }
  }
}

TEST_F(MitsubaShapes, OptionsOfMeshes) {
  write("a.obj", roof(20));
  EXPECT_THAT(good(shape("obj", "a.obj",
                         "<boolean name='collapse' value='true'/><boolean name='loadMaterials' "
                         "value='false'/><boolean name='flipTexCoords' value='false'/>"))
                  .warnings,
              IsEmpty());
  good("<shape type='sphere'><float name='silhouette_sampling_weight' value='1'/></shape>");
  const auto message = [&](const std::string& angle) { return error(scene(shape("obj", "a.obj", angle))); };
  for (const char* bad : {"-1", "181"})
    EXPECT_THAT(message("<float name='max_smooth_angle' value='" + std::string(bad) + "'/>"),
                AllOf(HasSubstr("scene.xml:2:"), HasSubstr("must be a number in (0, 180]")));
  EXPECT_THAT(
      message("<float name='max_smooth_angle' value='3'/><boolean name='face_normals' value='true'/>"),
      HasSubstr("either max_smooth_angle or face_normals"));
}

const std::string kHeader =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";

TEST_F(MitsubaShapes, AttributesOfVerticesByTheirNames) {
  write("a.ply",
        kHeader +
            "property float color_0\nproperty float color_1\nproperty float color_2\nproperty float heat_1\n"
            "property float tint_r\nproperty float tint_g\nproperty float tint_b\nelement face 1\n"
            "property list uchar int vertex_indices\nend_header\n"
            "0 0 0 .1 .2 .3 .7 1 0 0\n1 0 0 .4 .5 .6 .8 0 1 0\n0 1 0 .7 .8 .9 .9 0 0 1\n3 0 1 2\n");
  const auto colours = [&](const std::string& name) {
    return mesh(good(shape("ply", "a.ply", showing(name)))).colours;
  };
  using glm::vec3;
  EXPECT_THAT(colours("vertex_color"),
              ElementsAre(vec3(.1f, .2f, .3f), vec3(.4f, .5f, .6f), vec3(.7f, .8f, .9f)));
  EXPECT_THAT(colours("vertex_heat"), ElementsAre(vec3(.7f), vec3(.8f), vec3(.9f)));
  EXPECT_THAT(colours("vertex_tint_color"), ElementsAre(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)));
  EXPECT_THAT(error(scene(shape("ply", "a.ply", showing("vertex_cold")))),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("which has none")));
  EXPECT_THAT(error(scene(shape("ply", "a.ply", showing("colour")))),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("begins with vertex_ or face_")));
}

TEST_F(MitsubaShapes, AttributesOfFacesByTheirNames) {
  write("a.ply", kHeader +
                     "element face 2\nproperty list uchar int vertex_indices\nproperty float weight_1\n"
                     "property float r\nproperty float g\nproperty float b\nend_header\n"
                     "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 .25 1 0 0\n3 2 1 0 .5 0 1 0\n");
  EXPECT_THAT(mesh(good(shape("ply", "a.ply", showing("face_weight")))).face_colours,
              ElementsAre(glm::vec3(0.25f), glm::vec3(0.5f)));
  EXPECT_THAT(mesh(good(shape("ply", "a.ply", showing("face_color")))).face_colours,
              ElementsAre(glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)));
  const std::string both =
      "<bsdf type='blendbsdf'><texture type='mesh_attribute' name='weight'><string name='name' "
      "value='face_weight'/></texture>" +
      showing("face_color") + "<bsdf type='diffuse'/></bsdf>";
  EXPECT_THAT(error(scene(shape("ply", "a.ply", both))),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("show face_weight and face_color of one shape")));
}

TEST_F(MitsubaShapes, OfTwoSidesWithinTwoTheFrontIsSeenTwice) {
  const SceneDescription s = good(
      "<shape type='disk'><bsdf type='twosided'><bsdf type='twosided'><bsdf type='diffuse'><rgb "
      "name='reflectance' "
      "value='.1'/></bsdf><bsdf type='diffuse'/></bsdf></bsdf></shape>");
  const auto reflectance = [&](int bsdf) {
    return std::get<DiffuseBsdf>(s.bsdfs.at(std::size_t(bsdf)).model).reflectance.value.x;
  };
  EXPECT_EQ(reflectance(s.shapes[0].front_bsdf), 0.1f);
  EXPECT_EQ(reflectance(s.shapes[0].back_bsdf), 0.1f);
}

// --- skies in two parts

class MitsubaSkies : public SceneText {
 protected:
  const std::string direction_ = "<vector name='sunDirection' x='0.2' y='0.6' z='0.4'/>";
  std::string sky(const std::string& inside = "") const { return light("sky", inside); }
  std::string sun(const std::string& inside = "") const { return light("sun", inside); }
  std::string light(const std::string& type, const std::string& inside) const {
    return "<emitter type='" + type + "'>" + direction_ + "<integer name='resolution' value='64'/>" + inside +
           "</emitter>";
  }
  /// In the words of version 0.6.
  SceneDescription read_old(const std::string& lights) {
    auto result = read("<scene version='0.6.0'><sensor type='perspective'/><shape type='sphere'/>" + lights +
                       "</scene>");
    EXPECT_TRUE(result) << result.error().message;
    return result ? std::move(*result) : SceneDescription{};
  }
  std::string old_error(const std::string& lights) {
    return error("<scene version='0.6.0'><sensor type='perspective'/>\n" + lights + "</scene>");
  }
};

TEST_F(MitsubaSkies, ASkyAndASunAreBothInOne) {
  const std::string sky_scale = "<float name='scale' value='2'/>",
                    sun_scale = "<float name='scale' value='3'/><float name='sunRadiusScale' value='4'/>";
  const auto one = only<EnvironmentMapLight>(
      read_old(light("sunsky",
                     "<float name='skyScale' value='2'/><float name='sunScale' value='3'/>"
                     "<float name='sunRadiusScale' value='4'/>")));
  for (const bool sun_first : {false, true}) {
    const SceneDescription two =
        read_old(sun_first ? sun(sun_scale) + sky(sky_scale)
                           : sky(sky_scale) + "<emitter type='point'/>" + sun(sun_scale));
    const auto joined = only<EnvironmentMapLight>(two);
    EXPECT_EQ(joined.image->words, one.image->words) << sun_first;
    EXPECT_EQ(joined.to_world, one.to_world);
    EXPECT_TRUE(is_sky(two.emitters.front())) << "in the first one's place";
  }
}

TEST_F(MitsubaSkies, ABlackPartLeavesTheOther) {
  const auto whole = only<EnvironmentMapLight>(read_old(sky()));
  const auto unlit = only<EnvironmentMapLight>(read_old(sun("<float name='scale' value='0'/>") + sky()));
  EXPECT_EQ(unlit.image->words, whole.image->words);
}

TEST_F(MitsubaSkies, ASunWithoutADiskIsBesideTheSky) {
  const SceneDescription s = read_old(sky() + sun("<float name='sunRadiusScale' value='0'/>"));
  only<EnvironmentMapLight>(s);
  only<DirectionalLight>(s);
}

TEST_F(MitsubaSkies, WhatDoesNotBelongTogether) {
  EXPECT_THAT(old_error(sky() + sun("<float name='turbidity' value='5'/>")),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("have the same turbidity")));
  EXPECT_THAT(
      old_error(sky() + "<emitter type='sun'><vector name='sunDirection' x='1' y='1' z='0'/></emitter>"),
      HasSubstr("have the same sun_direction"));
  EXPECT_THAT(old_error(sky() + sun("<transform name='toWorld'><rotate y='1' angle='9'/></transform>")),
              HasSubstr("have the same to_world"));
  EXPECT_THAT(old_error(sky() + sky()), HasSubstr("emitter 'sky' is a second sky"));
  EXPECT_THAT(old_error(sky() + sun() + sun()), HasSubstr("emitter 'sun' is a second sky"));
  EXPECT_THAT(old_error(light("sunsky", "") + sun()), HasSubstr("emitter 'sun' is a second sky"));
  EXPECT_THAT(old_error("<emitter type='constant'/>" + sky()), HasSubstr("emitter 'sky' is a second sky"));
  EXPECT_THAT(old_error(sky() + "<emitter type='constant'/>"),
              HasSubstr("emitter 'constant' is a second sky"));
}

}  // namespace
}  // namespace penumbra::mitsuba_shapes_test
