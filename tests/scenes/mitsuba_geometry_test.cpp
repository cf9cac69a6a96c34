// Conversion of Mitsuba's shapes.
#include <cmath>
#include <numbers>

#include "tests/scenes/mitsuba_text.h"

namespace penumbra {
namespace {

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
  EXPECT_FALSE(good(in("shape", "cylinder", to_world("<scale x='-1'/>"))).shapes.at(0).flip_normals);
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
}

TEST_F(MitsubaPlugins, AnEllipticDiskIsAPolygonOfItsArea) {
  for (const double z : {1.0, -1.0}) {
    const SceneDescription s =
        good(in("shape", "disk", to_world(fmt::format("<scale x='3' y='2' z='{}'/><translate z='4'/>", z))));
    const Mesh& ellipse = std::get<Mesh>(s.shapes.at(0).geometry);
    double area = 0;
    for (const glm::uvec3& t : ellipse.triangles)
      area += 0.5 * glm::cross(ellipse.positions[t.y] - ellipse.positions[t.x],
                               ellipse.positions[t.z] - ellipse.positions[t.x])
                        .z;
    EXPECT_NEAR(area, z * 6 * std::numbers::pi, 1e-9) << "the front follows the normal";
    for (std::size_t i = 0; i < ellipse.positions.size(); ++i) {
      const glm::dvec3& p = ellipse.positions[i];
      const glm::vec2 uv = ellipse.texcoords[i];
      EXPECT_EQ(p.z, 4.0);
      EXPECT_NEAR(std::hypot(p.x / 3, p.y / 2), double(uv.x), 4e-5);
      if (uv.x > 0) {
        EXPECT_NEAR(p.x / 3, std::cos(2 * std::numbers::pi * double(uv.y)), 4e-5);
      }
    }
  }
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

}  // namespace
}  // namespace penumbra
