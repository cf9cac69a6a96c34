#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/mesh_reader.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Expected<Mesh> read(std::string text) { return read_obj({"m.obj", std::move(text)}); }

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

TEST(Obj, PartialNormalsAndTextureCoordinatesAreDropped) {
  const Mesh mesh = read(std::string(kSquare) + "vt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3//1\n").value();
  EXPECT_THAT(mesh.normals, SizeIs(3));
  EXPECT_THAT(mesh.texcoords, IsEmpty());
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
  EXPECT_THAT(error(square + "f 1/1 2/1 3/1\n"), HasSubstr("texture coordinate index 1"));
  EXPECT_THAT(error(square + "f 1//1 2//1 3//1\n"), HasSubstr("normal index 1"));
  EXPECT_THAT(error(square + "f 1 2\n"), HasSubstr("at least 3 corners, not 2"));
  EXPECT_THAT(error(square + "f 1/1/1/1 2 3\n"), HasSubstr("not a face corner"));
  EXPECT_THAT(error(square + "f 1.5 2 3\n"), HasSubstr("'1.5' is not an integer"));
  EXPECT_THAT(error(square + "f / 2 3\n"), HasSubstr("'' is not an integer"));
}

}  // namespace
}  // namespace penumbra
