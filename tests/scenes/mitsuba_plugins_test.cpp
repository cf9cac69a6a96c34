// What Mitsuba's plugins mean: shapes, materials, lights, cameras, films, samplers, integrators.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/scenes/scene_text.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using MitsubaPlugins = SceneText;

std::string in(std::string_view tag, std::string_view type, std::string_view content = "") {
  return "<" + std::string(tag) + " type='" + std::string(type) + "'>" + std::string(content) + "</" +
         std::string(tag) + ">";
}
std::string to_world(std::string_view steps) {
  return "<transform name='to_world'>" + std::string(steps) + "</transform>";
}

// --- shapes

TEST_F(MitsubaPlugins, Sphere) {
  const SceneDescription s =
      good(in("shape", "sphere",
              "<point name='center' x='1' y='2' z='3'/><float name='radius' value='2'/>" +
                  to_world("<scale value='3'/><rotate x='1' angle='90'/><translate x='10'/>")));
  const Sphere& sphere = std::get<Sphere>(s.shapes.at(0).geometry);
  EXPECT_LT(glm::distance(sphere.center, glm::dvec3(13, -9, 6)), 1e-14);
  EXPECT_DOUBLE_EQ(sphere.radius, 6.0);
  EXPECT_FALSE(s.shapes[0].flip_normals);
  EXPECT_TRUE(
      good(in("shape", "sphere", "<boolean name='flip_normals' value='true'/>")).shapes.at(0).flip_normals);
  EXPECT_TRUE(good(in("shape", "sphere", to_world("<scale x='-1'/>"))).shapes.at(0).flip_normals);
  EXPECT_THAT(error(scene(in("shape", "sphere", to_world("<scale x='2'/>")))),
              HasSubstr("scale all directions alike"));
  EXPECT_THAT(error(scene(in("shape", "sphere", "<float name='radius' value='0'/>"))),
              HasSubstr("above 0, not 0"));
  EXPECT_THAT(error(scene(in("shape", "sphere", "<float name='radius' value='1e300'/>"))),
              HasSubstr("too large"));
}

TEST_F(MitsubaPlugins, Cylinder) {
  const SceneDescription s =
      good(in("shape", "cylinder",
              "<point name='p0' x='1' y='2' z='3'/><point name='p1' x='1' y='6' z='3'/><float name='radius' "
              "value='.5'/>" +
                  to_world("<scale value='3'/><translate x='10'/>")) +
           in("shape", "cylinder", to_world("<scale x='2' y='2' z='7'/>")));
  const Cylinder& cylinder = std::get<Cylinder>(s.shapes.at(0).geometry);
  EXPECT_LT(glm::distance(cylinder.center, glm::dvec3(13, 6, 9)), 1e-13);
  EXPECT_LT(glm::distance(cylinder.axis, glm::dvec3(0, 1, 0)), 1e-14);
  EXPECT_DOUBLE_EQ(cylinder.radius, 1.5);
  EXPECT_DOUBLE_EQ(cylinder.length, 12.0);
  EXPECT_LT(glm::distance(glm::cross(cylinder.x_axis, cylinder.y_axis), cylinder.axis), 1e-14);
  const Cylinder& unit = std::get<Cylinder>(s.shapes.at(1).geometry);
  EXPECT_EQ(unit.x_axis, glm::dvec3(1, 0, 0));
  EXPECT_EQ(unit.y_axis, glm::dvec3(0, 1, 0));
  EXPECT_EQ(unit.radius, 2.0);
  EXPECT_EQ(unit.length, 7.0);
  EXPECT_FALSE(s.shapes[0].flip_normals);
  EXPECT_TRUE(good(in("shape", "cylinder", to_world("<scale x='-1'/>"))).shapes.at(0).flip_normals);
  EXPECT_THAT(error(scene(in("shape", "cylinder", to_world("<scale x='2'/>")))),
              HasSubstr("directions across its axis alike"));
  EXPECT_THAT(error(scene(in("shape", "cylinder", "<float name='radius' value='-1'/>"))),
              HasSubstr("above 0, not -1"));
  EXPECT_THAT(error(scene(in("shape", "cylinder", "<point name='p1' x='0' y='0' z='0'/>"))),
              HasSubstr("the ends of a cylinder must be apart"));
  EXPECT_THAT(error(scene(in("shape", "cylinder", "<float name='radius' value='1e300'/>"))),
              HasSubstr("too large"));
  EXPECT_THAT(error(scene(in("shape", "cylinder",
                             in("emitter", "area", "<boolean name='two_sided' value='true'/>")))),
              HasSubstr("a cylinder emits to one side"));
}

TEST_F(MitsubaPlugins, Disk) {
  const SceneDescription s = good(in(
      "shape", "disk", to_world("<scale x='2' y='2' z='9'/><rotate x='1' angle='-90'/><translate y='4'/>")));
  const Disk& disk = std::get<Disk>(s.shapes.at(0).geometry);
  EXPECT_LT(glm::distance(disk.center, glm::dvec3(0, 4, 0)), 1e-14);
  EXPECT_LT(glm::distance(disk.normal, glm::dvec3(0, 1, 0)), 1e-14);
  EXPECT_DOUBLE_EQ(disk.radius, 2.0);
  const SceneDescription mirrored = good(in("shape", "disk", to_world("<scale z='-1'/>")));
  EXPECT_EQ(std::get<Disk>(mirrored.shapes.at(0).geometry).normal, glm::dvec3(0, 0, -1));
  EXPECT_THAT(error(scene(in("shape", "disk", to_world("<scale x='2'/>")))),
              HasSubstr("directions of its plane alike"));
}

TEST_F(MitsubaPlugins, Meshes) {
  write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nvt 0 .25\nf 1/1 2/1 3/1\nf 1/1 2/1 4/1\n");
  const std::string name = "<string name='filename' value='m.obj'/>";
  const SceneDescription s = good(in("shape", "obj", name + to_world("<translate z='5'/>")));
  const Mesh& mesh = std::get<Mesh>(s.shapes.at(0).geometry);
  EXPECT_THAT(mesh.triangles, SizeIs(1));
  EXPECT_EQ(mesh.positions[0], glm::dvec3(0, 0, 5));
  EXPECT_EQ(mesh.texcoords[0], glm::vec2(0, 0.75f));  // an OBJ's v counts from the bottom
  const SceneDescription kept =
      good(in("shape", "obj", name + "<boolean name='flip_tex_coords' value='false'/>"));
  EXPECT_EQ(std::get<Mesh>(kept.shapes.at(0).geometry).texcoords[0], glm::vec2(0, 0.25f));
  ASSERT_THAT(s.warnings, SizeIs(1));
  EXPECT_THAT(s.warnings[0], AllOf(HasSubstr("scene.xml:2:2: warning: "),
                                   HasSubstr("m.obj: left out 1 triangle without area")));
}

TEST_F(MitsubaPlugins, MeshFilesMayBeginWithAByteOrderMark) {
  const std::string mark = "\xEF\xBB\xBF";
  write("m.obj", mark + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write("m.ply", mark +
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                     "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                     "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  for (const std::string type : {"obj", "ply"}) {
    const SceneDescription s = good(in("shape", type, "<string name='filename' value='m." + type + "'/>"));
    EXPECT_THAT(s.shapes, SizeIs(1));
  }
  write("m.obj", mark + "v 0 0 x\n");
  EXPECT_THAT(error(scene(in("shape", "obj", "<string name='filename' value='m.obj'/>"))),
              HasSubstr("m.obj:1:7: error: "));
  write("m.obj", std::string("\xFF\xFEv\0", 4));
  EXPECT_THAT(error(scene(in("shape", "obj", "<string name='filename' value='m.obj'/>"))),
              HasSubstr("m.obj' is UTF-16 text; save it as UTF-8"));
}

TEST_F(MitsubaPlugins, FacesThatFoldOverAreWarnedOf) {
  // Faces that are not flat are what smooth meshes are made of.
  write("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 1 .3\nf 1 2 5 4\nf 1 3 2 4\n");
  const SceneDescription s = good(in("shape", "obj", "<string name='filename' value='m.obj'/>"));
  ASSERT_THAT(s.warnings, SizeIs(1));
  EXPECT_THAT(without_folder(s.warnings[0]),
              HasSubstr("scene.xml:2:2: warning: m.obj: 1 face folds over or back on itself; cut into "
                        "fans of triangles that overlap; the first is m.obj:7:1"));
}

/// BSDFs of an OBJ file are for the materials of their names; one without a name is for all others.
TEST_F(MitsubaPlugins, ObjFilesOfSeveralMaterials) {
  write("m.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nusemtl Red\nf 1 2 3\nusemtl blue\nf 1 3 4\n"
        "usemtl Red\nf 1 2 5\nusemtl other\nf 2 3 5\n");
  const std::string file = "<string name='filename' value='m.obj'/>";
  const auto grey = [](const std::string& name, const std::string& value) {
    return "<bsdf type='diffuse'" + (name.empty() ? "" : " name='" + name + "'") +
           "><rgb name='reflectance' value='" + value + "'/></bsdf>";
  };
  const SceneDescription s =
      good(in("shape", "obj", file + grey("Red", ".1") + grey("blue", ".2") + grey("", ".3")));
  EXPECT_THAT(s.warnings, IsEmpty());
  ASSERT_THAT(s.shapes, SizeIs(3));
  const float expected[] = {0.1f, 0.2f, 0.3f};
  const std::size_t triangles[] = {2, 1, 1};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(std::get<Mesh>(s.shapes[i].geometry).triangles.size(), triangles[i]);
    EXPECT_EQ(std::get<DiffuseBsdf>(s.bsdfs.at(std::size_t(s.shapes[i].front_bsdf)).model).reflectance,
              glm::vec3(expected[i]));
  }
  const SceneDescription some = good(in("shape", "obj", file + grey("blue", ".2") + grey("green", ".4")));
  EXPECT_EQ(std::get<DiffuseBsdf>(some.bsdfs.at(std::size_t(some.shapes[0].front_bsdf)).model).reflectance,
            glm::vec3(0.5f));
  EXPECT_THAT(some.warnings, ElementsAre(HasSubstr("no faces of the file have the material 'green'")));
  EXPECT_THAT(error(scene(in("shape", "obj", file + grey("blue", ".2") + grey("blue", ".4")))),
              HasSubstr("two BSDFs are named 'blue'"));
}

TEST_F(MitsubaPlugins, AMeshWithoutTrianglesIsLeftOut) {
  write("m.obj", "v 0 0 0\n");
  const SceneDescription s = good(in("shape", "obj", "<string name='filename' value='m.obj'/>"));
  EXPECT_THAT(s.shapes, IsEmpty());
  EXPECT_THAT(s.warnings, ElementsAre(HasSubstr("has no triangles; it is left out")));
}

TEST_F(MitsubaPlugins, MeshErrorsNameBothFiles) {
  EXPECT_THAT(
      error(scene("\n" + in("shape", "obj", "<string name='filename' value='none.obj'/>"))),
      AllOf(HasSubstr("scene.xml:3:50: error: there is no file 'none.obj'; looked in: "), HasSubstr("^")));
  write("bad.obj", "v 0 0 0\nv 1 0 inf\n");
  EXPECT_THAT(error(scene(in("shape", "obj", "<string name='filename' value='bad.obj'/>"))),
              AllOf(HasSubstr("bad.obj:2:7: error: 'inf' is not a finite number"),
                    HasSubstr("named at scene.xml:2:2")));
  EXPECT_THAT(error(scene(in("shape", "ply"))),
              HasSubstr("shape 'ply' needs a <string name=\"filename\" …>"));
  EXPECT_THAT(error(scene(in("shape", "obj", "<string name='filename' value='/dev/zero'/>"))),
              HasSubstr("not a plain file"));
  EXPECT_THAT(error(scene(in("shape", "obj", "<string name='filename' value=''/>"))),
              HasSubstr("file name is empty"));
}

// --- materials

TEST_F(MitsubaPlugins, DiffuseIsOneSidedAndTheDefault) {
  const SceneDescription s =
      good(in("shape", "sphere") + in("shape", "cube") +
           in("shape", "cube", in("bsdf", "diffuse", "<rgb name='reflectance' value='.1 .2 .3'/>")));
  ASSERT_THAT(s.shapes, SizeIs(3));
  EXPECT_EQ(s.shapes[0].front_bsdf, s.shapes[1].front_bsdf);
  EXPECT_EQ(std::get<DiffuseBsdf>(s.bsdfs.at(std::size_t(s.shapes[0].front_bsdf)).model).reflectance,
            glm::vec3(0.5f));
  EXPECT_EQ(std::get<DiffuseBsdf>(s.bsdfs.at(std::size_t(s.shapes[2].front_bsdf)).model).reflectance,
            glm::vec3(0.1f, 0.2f, 0.3f));
  for (const Shape& shape : s.shapes) EXPECT_EQ(shape.back_bsdf, kBlackBsdf);
}

TEST_F(MitsubaPlugins, ALampWithoutABsdfIsBlack) {
  for (const std::string version : {"0.5.0", "0.6.0", "2.0.0", "3.0.0"}) {
    const std::string content =
        in("shape", "cube", in("emitter", "area")) + in("shape", "cube") +
        in("shape", "cube", in("emitter", "area", "<rgb name='radiance' value='0'/>")) +
        in("shape", "cube", in("bsdf", "diffuse") + in("emitter", "area"));
    const auto s =
        read("<scene version='" + version + "'>" + content + "<sensor type='perspective'/></scene>");
    ASSERT_TRUE(s) << s.error().message;
    ASSERT_THAT(s->shapes, SizeIs(4));
    for (const std::size_t lamp : {0u, 2u}) {
      EXPECT_EQ(s->shapes[lamp].front_bsdf, kBlackBsdf);
      EXPECT_EQ(s->shapes[lamp].back_bsdf, kBlackBsdf);
    }
    EXPECT_NE(s->shapes[1].front_bsdf, kBlackBsdf);
    EXPECT_NE(s->shapes[3].front_bsdf, kBlackBsdf);
  }
}

TEST_F(MitsubaPlugins, PhongDefaults) {
  const SceneDescription s = good(in("shape", "sphere", in("bsdf", "phong")));
  const PhongBsdf& phong = std::get<PhongBsdf>(s.bsdfs.at(0).model);
  EXPECT_EQ(phong.exponent, 30.0f);
  EXPECT_EQ(phong.diffuse, glm::vec3(0.5f));
  EXPECT_EQ(phong.specular, glm::vec3(0.2f));
  EXPECT_THAT(error(scene(in("bsdf", "phong", "<float name='exponent' value='-1'/>"))),
              HasSubstr("0 or more, not -1"));
}

TEST_F(MitsubaPlugins, APhongThatGivesMoreThanItGetsIsAWarning) {
  const std::string more =
      "<rgb name='diffuse_reflectance' value='.5'/><rgb name='specular_reflectance' value='.2 .6 .2'/>";
  EXPECT_THAT(good(in("shape", "sphere", in("bsdf", "phong", more))).warnings,
              ElementsAre(HasSubstr("bsdf 'phong': diffuse and specular")));
}

TEST_F(MitsubaPlugins, PrincipledByIndexOrBySpecular) {
  const auto read_one = [&](std::string_view content) {
    return std::get<PrincipledBsdf>(
        good(in("shape", "sphere", in("bsdf", "principled", content))).bsdfs.at(0).model);
  };
  EXPECT_NEAR(read_one("").eta, 1.5f, 1e-6f);  // specular 0.5
  EXPECT_NEAR(read_one("<float name='specular' value='1'/>").eta, 1.788789f, 1e-6f);
  EXPECT_EQ(read_one("<float name='specular' value='0'/>").eta, 1.0f);
  EXPECT_EQ(read_one("<float name='eta' value='1'/>").eta, 1.0f);
  EXPECT_EQ(read_one("<float name='eta' value='0.8'/>").eta, 0.8f);
  // Where it transmits, an index of 1 would refract each direction into itself.
  const std::string transmits = "<float name='spec_trans' value='0.3'/>";
  EXPECT_GT(read_one(transmits + "<float name='specular' value='0'/>").eta, 1.0f);
  EXPECT_GT(read_one(transmits + "<float name='eta' value='1'/>").eta, 1.0f);
  EXPECT_THAT(error(scene(in("bsdf", "principled",
                             "<float name='eta' value='1.3'/><float name='specular' value='0.5'/>"))),
              HasSubstr("specular is another name for eta"));
  EXPECT_THAT(error(scene(in("bsdf", "principled", "<float name='eta' value='0'/>"))),
              HasSubstr("number above 0, not 0"));
  EXPECT_THAT(error(scene(in("bsdf", "principled", "<float name='metallic' value='1.5'/>"))),
              HasSubstr("metallic must be a number in [0, 1], not 1.5"));
  EXPECT_THAT(error(scene(in("bsdf", "principledthin", "<float name='diff_trans' value='2.5'/>"))),
              HasSubstr("[0, 2]"));
}

TEST_F(MitsubaPlugins, PrincipledIsSeenFromInsideWhereItTransmits) {
  const SceneDescription opaque = good(in("shape", "sphere", in("bsdf", "principled")));
  EXPECT_EQ(opaque.shapes.at(0).back_bsdf, kBlackBsdf);
  const SceneDescription glass = good(
      in("shape", "sphere",
         in("bsdf", "principled", "<float name='spec_trans' value='1'/><float name='eta' value='1.6'/>")));
  const auto side = [&](int bsdf) {
    return material_of(std::get<PrincipledBsdf>(glass.bsdfs.at(std::size_t(bsdf)).model));
  };
  const Material front = side(glass.shapes.at(0).front_bsdf), back = side(glass.shapes.at(0).back_bsdf);
  EXPECT_EQ(front.ior, 1.6f);
  EXPECT_EQ(back.ior, 1 / 1.6f);
  EXPECT_NE(front.variant, back.variant);
  const SceneDescription thin = good(in("shape", "sphere", in("bsdf", "principledthin")));
  EXPECT_EQ(thin.shapes.at(0).front_bsdf, thin.shapes.at(0).back_bsdf);
  // Both sides of an opaque one are what twosided is for.
  EXPECT_EQ(good(in("shape", "sphere", in("bsdf", "twosided", in("bsdf", "principled")))).bsdfs.size(), 1u);
  EXPECT_THAT(error(scene(in("bsdf", "twosided", in("bsdf", "principledthin")))),
              HasSubstr("lets light through"));
}

TEST_F(MitsubaPlugins, ALobeThatIsNeverSampledIsAWarning) {
  const auto warnings = [&](std::string_view type, std::string_view content) {
    return good(in("shape", "sphere", in("bsdf", type, content))).warnings;
  };
  EXPECT_THAT(warnings("principled", "<float name='diffuse_reflectance_sampling_rate' value='0'/>"),
              ElementsAre(HasSubstr("diffuse_reflectance_sampling_rate is 0")));
  EXPECT_THAT(warnings("principled", "<float name='clearcoat_sampling_rate' value='0'/>"), IsEmpty());
  EXPECT_THAT(warnings("principledthin", "<float name='specular_transmittance_sampling_rate' value='0'/>"),
              IsEmpty());
  EXPECT_THAT(warnings("principledthin",
                       "<float name='spec_trans' value='1'/><float "
                       "name='specular_transmittance_sampling_rate' value='0'/>"),
              ElementsAre(HasSubstr("never sampled")));
}

TEST_F(MitsubaPlugins, DisneyByTheNamesOfItsAuthors) {
  const SceneDescription s =
      good(in("shape", "sphere",
              in("bsdf", "disney",
                 "<rgb name='baseColor' value='.2 .4 .6'/><float name='clearcoatGloss' value='.3'/><float "
                 "name='specularTint' value='.25'/><float name='subsurface' value='.75'/>")));
  const Material m = material_of(std::get<DisneyBsdf>(s.bsdfs.at(0).model));
  EXPECT_EQ(m.diffuse.z, 0.6f);
  EXPECT_EQ(m.clearcoat_gloss, 0.3f);
  EXPECT_EQ(m.spec_tint, 0.25f);
  EXPECT_EQ(m.flatness, 0.75f);
  EXPECT_EQ(m.specular_level, 0.5f);
  EXPECT_EQ(s.shapes.at(0).back_bsdf, kBlackBsdf);
}

TEST_F(MitsubaPlugins, TwoSided) {
  const SceneDescription s =
      good(in("shape", "sphere", in("bsdf", "twosided", in("bsdf", "diffuse"))) +
           in("shape", "cube", in("bsdf", "twosided", in("bsdf", "diffuse") + in("bsdf", "phong"))));
  EXPECT_EQ(s.shapes.at(0).front_bsdf, s.shapes.at(0).back_bsdf);
  EXPECT_TRUE(std::holds_alternative<DiffuseBsdf>(s.bsdfs.at(std::size_t(s.shapes.at(1).front_bsdf)).model));
  EXPECT_TRUE(std::holds_alternative<PhongBsdf>(s.bsdfs.at(std::size_t(s.shapes.at(1).back_bsdf)).model));
  EXPECT_THAT(error(scene(in("bsdf", "twosided"))), HasSubstr("one bsdf (for both sides) or two, not 0"));
}

TEST_F(MitsubaPlugins, ReflectancesAreChecked) {
  for (const char* value : {"1.1", "-0.1", "0 0 2"}) {
    EXPECT_THAT(
        error(scene(in("bsdf", "diffuse", "<rgb name='reflectance' value='" + std::string(value) + "'/>"))),
        HasSubstr("a reflectance must be between 0 and 1"))
        << value;
  }
}

TEST_F(MitsubaPlugins, UnknownParametersListTheKnown) {
  EXPECT_EQ(error(scene(in("bsdf", "diffuse", "<rgb name='reflectence' value='1'/>"))),
            "scene.xml:2:23: error: bsdf 'diffuse' has no parameter 'reflectence'; did you mean "
            "'reflectance'? It has: "
            "reflectance\n  <bsdf type='diffuse'><rgb name='reflectence' value='1'/></bsdf>\n"
            "                        ^");
  EXPECT_THAT(error(scene(in("shape", "sphere", "<integer name='shape_index' value='1'/>"))),
              HasSubstr("shape 'sphere' has no parameter 'shape_index'"));
  EXPECT_THAT(error(scene(in("shape", "sphere", in("sensor", "perspective")))),
              HasSubstr("shape 'sphere' cannot hold a <sensor>"));
  EXPECT_THAT(error(scene(in("shape", "sphere", "<string name='radius' value='1'/>"))),
              HasSubstr("the parameter 'radius' of shape 'sphere' must be a <float>, not a <string>"));
  EXPECT_THAT(error(scene(in("shape", "sphere", in("bsdf", "diffuse") + in("bsdf", "phong")))),
              HasSubstr("shape 'sphere' has 2 of <bsdf>; it takes one"));
}

// --- lights

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

// --- cameras and films

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
  EXPECT_THAT(error("<scene version='3.0.0'/>"), HasSubstr("the scene has no <sensor>"));
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
              ::testing::ElementsAre(HasSubstr("nothing moves")));
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

// --- integrators

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
  EXPECT_THAT(message("stokes"), HasSubstr("integrator type 'stokes' is not one that Penumbra reads"));
  EXPECT_THAT(error(scene("<integrator type='moment' id='a'><ref id='a'/></integrator>")),
              HasSubstr("needs an <integrator>"));
  EXPECT_THAT(error(scene(in("integrator", "path") + in("integrator", "path"))),
              HasSubstr("2 of <integrator>"));
}

// --- leniency

TEST_F(MitsubaPlugins, LenientStandIns) {
  const std::string text =
      in("integrator", "stokes", "<integer name='max_depth' value='4'/>") +
      in("sensor", "spherical",
         "<float name='fov' value='30'/><float name='aperture_radius' value='1'/>" +
             in("film", "specfilm", "<integer name='width' value='99'/>" + in("rfilter", "welch")) +
             in("sampler", "magic", "<integer name='sample_count' value='3'/>")) +
      in("shape", "sphere", in("bsdf", "twosided", in("bsdf", "hair", "<float name='alpha' value='.1'/>"))) +
      in("shape", "cube",
         in("bsdf", "diffuse",
            "<texture type='bitmap' name='reflectance'><string name='filename' value='x'/></texture>") +
             in("emitter", "area", "<texture type='marble' name='radiance'/>")) +
      in("shape", "hair") + in("emitter", "laser") + in("medium", "homogeneous");
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
          HasSubstr("integrator type 'stokes' is not one that Penumbra reads; path stands in"),
          HasSubstr("sensor type 'spherical'"), HasSubstr("film type 'specfilm'"),
          HasSubstr("rfilter type 'welch'"), HasSubstr("sampler type 'magic'"), HasSubstr("bsdf type 'hair'"),
          HasSubstr("no file 'x'"), HasSubstr("texture type 'marble'"), HasSubstr("shape type 'hair'"),
          HasSubstr("emitter type 'laser'"), HasSubstr("medium type 'homogeneous'")));
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
