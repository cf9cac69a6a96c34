#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "scenes/mesh_reader.h"

namespace penumbra::mesh_obj_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

Expected<Mesh> read(std::string text) {
  auto file = read_obj({"m.obj", std::move(text)});
  if (!file) return std::unexpected(file.error());
  return std::move(file->mesh);
}

std::string error(std::string text) {
  const auto mesh = read(std::move(text));
  EXPECT_FALSE(mesh);
  return mesh ? "" : mesh.error().message;
}

constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Obj, PolygonsAreFans) {
  const Mesh mesh = read(std::string(kSquare) + "f 1 2 3 4\n").value();
  EXPECT_THAT(mesh.positions, ElementsAre(glm::dvec3(0, 0, 0), glm::dvec3(1, 0, 0), glm::dvec3(1, 1, 0),
                                          glm::dvec3(0, 1, 0)));
  EXPECT_THAT(mesh.triangles, ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3)));
  EXPECT_THAT(mesh.normals, IsEmpty());
  EXPECT_THAT(mesh.texcoords, IsEmpty());
}

TEST(Obj, NegativeIndicesCountFromTheLast) {
  const Mesh a = read(std::string(kSquare) + "f -4 -3 -2\nv 5 5 5\nf -1 1 2\n").value();
  EXPECT_THAT(a.positions[a.triangles[1].x], glm::dvec3(5, 5, 5));
  EXPECT_THAT(a.positions[a.triangles[0].x], glm::dvec3(0, 0, 0));
}

TEST(Obj, CornersWithDifferentNormalsAreDifferentVertices) {
  const Mesh mesh = read(std::string(kSquare) +
                         "vt 0 0\nvt 1 0 0\nvt 1 1\nvn 0 0 1\nvn 0 1 0\n"
                         "f 1/1/1 2/2/1 3/3/1\nf 1/1/2 3/3/1 4/1/1\n")
                        .value();
  EXPECT_THAT(mesh.positions, SizeIs(5));
  EXPECT_THAT(mesh.normals, SizeIs(5));
  EXPECT_THAT(mesh.texcoords, SizeIs(5));
  EXPECT_EQ(mesh.normals[mesh.triangles[1].x], glm::vec3(0, 1, 0));
  EXPECT_EQ(mesh.normals[mesh.triangles[0].x], glm::vec3(0, 0, 1));
}

TEST(Obj, NormalsAndTextureCoordinatesThatSomeCornersLackAreZeroThere) {
  const MeshFile file =
      read_obj({"m.obj", std::string(kSquare) + "vt .25 .5\nvn 0 0 1\nf 1/1/1 2//1 3/1\nf 1/1/1 3/1 4/1/1\n"})
          .value();
  EXPECT_THAT(file.mesh.texcoords, ElementsAre(glm::vec2(0.25f, 0.5f), glm::vec2(0), glm::vec2(0.25f, 0.5f),
                                               glm::vec2(0.25f, 0.5f)));
  EXPECT_THAT(file.mesh.normals,
              ElementsAre(glm::vec3(0, 0, 1), glm::vec3(0, 0, 1), glm::vec3(0), glm::vec3(0, 0, 1)));
  EXPECT_THAT(
      describe(file.faces),
      ElementsAre("1 face has corners without texture coordinates; (0, 0) stands in for them; the first is "
                  "m.obj:7:1"));
  const MeshFile none = read_obj({"m.obj", std::string(kSquare) + "vn 0 0 1\nf 1//1 2//1 3//1\n"}).value();
  EXPECT_THAT(none.mesh.texcoords, IsEmpty());
  EXPECT_THAT(describe(none.faces), IsEmpty());
}

TEST(Obj, FacesOfFewerThanThreeCornersAreLeftOut) {
  const MeshFile file = read_obj({"m.obj", std::string(kSquare) + "f 1 2\nf 1 2 3\nf 4\n"}).value();
  EXPECT_THAT(file.mesh.triangles, ElementsAre(glm::uvec3(0, 1, 2)));
  EXPECT_THAT(describe(file.faces),
              ElementsAre("2 faces have fewer than 3 corners; they are left out; the first is m.obj:5:1"));
}

TEST(Obj, OddButLegalText) {
  const Mesh mesh = read(
                        "# comment\r\n\r\nmtllib x.mtl\r\no thing\r\ng a b\r\ns off\r\nusemtl red\r\n"
                        "v\t0 0 0 1.0 # weight\r\nv 1 0 \\\r\n 0\r\nv 1 1 0 .5 .5 .5\r\nl 1 2\r\nf 1 2 3")
                        .value();
  EXPECT_THAT(mesh.positions, SizeIs(3));
  EXPECT_THAT(mesh.triangles, SizeIs(1));
  EXPECT_THAT(read("").value().triangles, IsEmpty());
}

TEST(Obj, ErrorsShowTheirPlace) {
  EXPECT_EQ(error("v 0 0 0\nv 1 nan 0\n"),
            "m.obj:2:5: error: 'nan' is not a finite number\n  v 1 nan 0\n      ^");
  EXPECT_THAT(error("v 0 0 x\n"), HasSubstr("m.obj:1:7: error: 'x' is not a number"));
  EXPECT_THAT(error("v 0 0\n"), HasSubstr("'v' takes at least 3 numbers, not 2"));
  EXPECT_THAT(error("v 0 0 0 0 0 0 0 0\n"), HasSubstr("at most 7"));
  EXPECT_THAT(error("vn 0 0 1e999\n"), HasSubstr("too large"));
  EXPECT_THAT(error("vv 0 0 0\n"), HasSubstr("'vv' is not an OBJ statement"));
  EXPECT_THAT(error("usemlt red\n"), HasSubstr("did you mean 'usemtl'?"));
}

TEST(Obj, BadFaces) {
  const std::string square = kSquare;
  EXPECT_THAT(error(square + "f 1 2 5\n"), HasSubstr("m.obj:5:7: error: vertex index 5 is out of range"));
  EXPECT_THAT(error(square + "f 1 2 0\n"), HasSubstr("vertex index 0"));
  EXPECT_THAT(error(square + "f 1 2 -5\n"), HasSubstr("vertex index -5"));
  EXPECT_THAT(error(square + "f 1 2 99999999999999999999\n"), HasSubstr("99999999999999999999"));
  EXPECT_THAT(error(square + "f 1/-1 2/-1 3/-1\n"), HasSubstr("texture coordinate index -1"));
  EXPECT_THAT(error(square + "f 1//0 2//0 3//0\n"), HasSubstr("normal index 0"));
  EXPECT_THAT(error(square + "f 1/1/1/1 2 3\n"), HasSubstr("not a face corner"));
  EXPECT_THAT(error(square + "f 1.5 2 3\n"), HasSubstr("'1.5' is not an integer"));
  EXPECT_THAT(error(square + "f / 2 3\n"), HasSubstr("'' is not an integer"));
}

TEST(Obj, NormalsAndTextureCoordinatesMayFollowTheFaces) {
  const MeshFile file =
      read_obj({"m.obj", std::string(kSquare) + "f 1/1/1 2/2/1 3/1/1\nvt 0 0\nvt 1 0\nvn 0 0 1\n"}).value();
  EXPECT_THAT(file.mesh.texcoords, ElementsAre(glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 0)));
  EXPECT_THAT(file.mesh.normals, ElementsAre(glm::vec3(0, 0, 1), glm::vec3(0, 0, 1), glm::vec3(0, 0, 1)));
  EXPECT_THAT(file.warnings, IsEmpty());
}

TEST(Obj, WhatFacesNameInVainIsLeftOut) {
  const MeshFile file = read_obj({"m.obj", std::string(kSquare) + "vt 0 0\nf 1/1/1 2/1/2 3/2/3\n"}).value();
  EXPECT_THAT(file.mesh.triangles, SizeIs(1));
  EXPECT_THAT(file.mesh.texcoords, SizeIs(3));
  EXPECT_THAT(file.mesh.normals, IsEmpty());
  EXPECT_THAT(file.warnings,
              ElementsAre("1 vertex names a texture coordinate that the file does not have, and goes without",
                          "3 vertices name a normal that the file does not have, and go without"));
}

TEST(Obj, StatementsOfOtherProgramsArePassedOver) {
  const MeshFile file = read_obj({"m.obj", std::string(kSquare) + "vc 1 0 0\nvw 0 1 0.5\nf 1 2 3\n"}).value();
  EXPECT_THAT(file.mesh.triangles, SizeIs(1));
  EXPECT_THAT(file.warnings,
              ElementsAre("2 statements are ignored, the first of them: m.obj:5:1: error: 'vc' is not an OBJ "
                          "statement of polygon meshes; did you mean 'vp'?"));
}

TEST(Obj, ConcavePolygonsAreCutInside) {
  Mesh arrow = read("v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\nf 1 2 3 4\n").value();
  for (glm::uvec3& t : arrow.triangles) {  // the smallest corner first, in the same order
    while (t.x > std::min(t.y, t.z)) t = {t.y, t.z, t.x};
  }
  EXPECT_THAT(arrow.triangles, UnorderedElementsAre(glm::uvec3(0, 1, 3), glm::uvec3(1, 2, 3)));
  EXPECT_THAT(arrow.positions, SizeIs(4));
}

Expected<ObjModel> read_groups(std::string text) { return read_obj_groups({"m.obj", std::move(text)}); }

TEST(ObjGroups, ByObjectAndMaterialInTheirOrder) {
  const SourceFile file{"m.obj", std::string(kSquare) +
                                     "mtllib a b.mtl # two\nf 1 2 3\no  my box \t\nusemtl red\nf 2 3 4\ng\n"
                                     "usemtl red # one\nf 1 3 4\no my box\nf 1 2 4\nmtllib c.mtl\n"};
  const ObjModel model = read_obj_groups(file).value();
  ASSERT_THAT(model.libraries, SizeIs(2));
  EXPECT_EQ(model.libraries[0].name, "a b.mtl");
  EXPECT_EQ(describe(model.libraries[0].location), "m.obj:5:8");
  EXPECT_EQ(model.libraries[1].name, "c.mtl");
  ASSERT_THAT(model.groups, SizeIs(3));
  EXPECT_EQ(model.groups[0].object, "");
  EXPECT_EQ(model.groups[0].material.name, "");
  EXPECT_EQ(model.groups[1].object, "my box");
  EXPECT_EQ(model.groups[1].material.name, "red");
  EXPECT_EQ(describe(model.groups[1].material.location), "m.obj:8:8");
  EXPECT_EQ(describe(model.groups[1].location), "m.obj:9:1");
  EXPECT_THAT(model.groups[1].mesh.triangles, ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(3, 0, 2)));
  EXPECT_THAT(model.groups[1].mesh.positions, SizeIs(4));
  EXPECT_EQ(model.groups[2].object, "");
  EXPECT_THAT(model.groups[2].mesh.positions, SizeIs(3));
  EXPECT_THAT(read_groups("").value().groups, IsEmpty());
  // All of it in one, as read_obj has it.
  EXPECT_THAT(read_obj(file).value().mesh.triangles, SizeIs(4));
}

TEST(ObjGroups, NormalsCountForEachGroup) {
  const ObjModel model =
      read_groups(std::string(kSquare) + "vn 0 0 1\no a\nf 1//1 2//1 3//1\no b\nf 1 2 3\n").value();
  EXPECT_THAT(model.groups.at(0).mesh.normals, SizeIs(3));
  EXPECT_THAT(model.groups.at(1).mesh.normals, IsEmpty());
}

TEST(ObjGroups, OddFacesAreCountedWhereTheyAre) {
  const SourceFile file{"m.obj",
                        std::string(kSquare) + "v 1 1 .1\nf 1 3 2 4\nf 1 2 3 4\nf 4 2 3 1\nf 1 2 5 4\n"};
  const ObjModel model = read_obj_groups(file).value();
  const ObjGroup& group = model.groups.at(0);
  EXPECT_EQ(group.faces.tangled.count, 2u);
  EXPECT_EQ(describe(group.faces.tangled.first), "m.obj:6:1");
  EXPECT_EQ(group.faces.warped.count, 1u);
  EXPECT_EQ(describe(group.faces.warped.first), "m.obj:9:1");
  // A corner of a unit square lifted by 0.1: the mean plane is 0.025 from all four.
  EXPECT_NEAR(group.faces.deviation, 0.025, 1e-4);
}

TEST(ObjGroups, NamesThatGoOnInTheNextLine) {
  const ObjModel model =
      read_groups(std::string(kSquare) + "g one \\\r\n two\nusemtl a\\b\nf 1 2 3\n").value();
  EXPECT_EQ(model.groups.at(0).object, "one");
  EXPECT_EQ(model.groups.at(0).material.name, "a\\b");
}

TEST(ObjGroups, NamesHaveALength) {
  const std::string longest(1024, 'n');
  for (const std::string keyword : {"o", "g", "usemtl"}) {
    EXPECT_TRUE(read_groups(keyword + " " + longest + "\n")) << keyword;
    const auto result = read_groups("v 0 0 0\n" + keyword + " " + longest + "n\n");
    ASSERT_FALSE(result) << keyword;
    EXPECT_THAT(result.error().message, HasSubstr("m.obj:2:")) << keyword;
    EXPECT_THAT(result.error().message, HasSubstr("has 1025 bytes; the most that are read are 1024"));
  }
}

TEST(ObjGroups, FacesThatCannotBeCut) {
  std::string text;
  std::string face = "f";
  for (int i = 0; i < 20000; ++i) {
    text += "v " + std::to_string(i) + (i % 2 == 0 ? " 0 0\n" : " 1 0\n");
    face += " " + std::to_string(i + 1);
  }
  EXPECT_THAT(error(text + "v 20000 -5 0\nv 0 -5 0\n" + face + " 20001 20002\n"),
              HasSubstr("m.obj:20003:1: error: a face of 20002 corners that is not convex; at most 16384"));
}

}  // namespace
}  // namespace penumbra::mesh_obj_test
