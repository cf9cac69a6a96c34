#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "scenes/mesh_reader.h"
#include "tests/scenes/ply_writer.h"

namespace penumbra::mesh_ply_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

Expected<Mesh> read(std::string text) {
  auto file = read_ply({"m.ply", std::move(text)});
  if (!file) return std::unexpected(file.error());
  return std::move(file->mesh);
}

std::string error(std::string text) {
  const auto mesh = read(std::move(text));
  EXPECT_FALSE(mesh);
  return mesh ? "" : mesh.error().message;
}

class PlyEncodings : public ::testing::TestWithParam<PlyEncoding> {};

TEST_P(PlyEncodings, GiveTheSameMesh) {
  const auto read_back = read(odd_square_ply(GetParam()));
  ASSERT_TRUE(read_back) << read_back.error().message;
  const Mesh& mesh = *read_back;
  EXPECT_THAT(mesh.positions, ElementsAre(glm::dvec3(0, 0, 0.125), glm::dvec3(0.5, 0, 0.125),
                                          glm::dvec3(0.5, -1, 0.125), glm::dvec3(0, -1, 0.125)));
  EXPECT_THAT(mesh.triangles, ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3)));
  EXPECT_THAT(mesh.normals, ElementsAre(glm::vec3(0, 0, -1), glm::vec3(0, 0, -1), glm::vec3(0, 0, -1),
                                        glm::vec3(0, 0, -1)));
  EXPECT_THAT(mesh.texcoords,
              ElementsAre(glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)));
}

/// Every shorter file is an error, but for the space at the end of the text.
TEST_P(PlyEncodings, TruncatedAnywhereIsAnError) {
  const std::string whole = odd_square_ply(GetParam());
  const std::size_t last = whole.find_last_not_of(" \n");
  const std::size_t end = GetParam() == PlyEncoding::kAscii ? last + 1 : whole.size();
  for (std::size_t size = 0; size < end; ++size) {
    const auto mesh = read(whole.substr(0, size));
    ASSERT_FALSE(mesh) << "cut to " << size << " bytes";
    ASSERT_THAT(mesh.error().message, HasSubstr("m.ply:"));
  }
}

INSTANTIATE_TEST_SUITE_P(All, PlyEncodings,
                         ::testing::Values(PlyEncoding::kAscii, PlyEncoding::kLittleEndian,
                                           PlyEncoding::kBigEndian));

/// An arrow head, concave at its last corner, as one face; its front is towards +z.
const glm::vec3 kArrow[] = {{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {0.5f, 1, 0}};

std::string arrow_ply(PlyEncoding encoding, bool faces_first) {
  PlyWriter ply(encoding);
  const auto put_face = [&] {
    ply.put(std::uint8_t(4));
    for (const std::int32_t corner : {0, 1, 2, 3}) ply.put(corner);
    ply.end_element();
  };
  if (faces_first) put_face();
  for (const glm::vec3& p : kArrow) {
    for (const float x : {p.x, p.y, p.z}) ply.put(x);
    ply.end_element();
  }
  if (!faces_first) put_face();
  const std::string vertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  return ply.file(faces_first ? faces + vertices : vertices + faces);
}

/// As in an OBJ file: a fan about the first corner would cover what the arrow leaves out.
TEST_P(PlyEncodings, AConcaveFaceIsCutAsInAnObj) {
  std::string obj;
  for (const glm::vec3& p : kArrow)
    obj += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  const Mesh same = read_obj({"m.obj", obj + "f 1 2 3 4\n"}).value().mesh;
  for (const bool faces_first : {false, true}) {
    const Mesh mesh = read(arrow_ply(GetParam(), faces_first)).value();
    EXPECT_EQ(mesh.triangles, same.triangles);
    double area = 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 n =
          glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
      EXPECT_GT(n.z, 0.0);
      area += 0.5 * n.z;
    }
    EXPECT_DOUBLE_EQ(area, 1.5);
  }
}

const std::string kHeader =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

TEST(Ply, CarriageReturns) {
  std::string text = kHeader + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (std::size_t at = text.find('\n'); at != text.npos; at = text.find('\n', at + 2)) text.insert(at, "\r");
  EXPECT_THAT(read(text).value().triangles, SizeIs(1));
}

TEST(Ply, FacesOfFewerThanThreeCornersAreLeftOut) {
  std::string text = kHeader + "0 0 0\n1 0 0\n0 1 0\n0\n3 0 1 2\n2 0 1\n1 0\n";
  text.replace(text.find("face 1"), 6, "face 4");
  const MeshFile file = read_ply({"m.ply", text}).value();
  EXPECT_THAT(file.mesh.triangles, SizeIs(1));
  ASSERT_THAT(describe(file.faces), SizeIs(1));
  EXPECT_EQ(describe(file.faces)[0],
            "3 faces have fewer than 3 corners; they are left out; the first is face 0");
}

TEST(Ply, BodyErrorsNameTheElement) {
  EXPECT_EQ(error(kHeader + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"),
            "m.ply:11:3: error: vertex 1: 'nan' is not a finite number\n  1 nan 0\n    ^");
  EXPECT_THAT(error(kHeader + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
              HasSubstr("face 0: vertex index 3 is out of range"));
  EXPECT_THAT(error(kHeader + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), HasSubstr("vertex index -1"));
  EXPECT_THAT(error(kHeader + "0 0 0\n1 0 0\n0 1 0\n3 0 1 .5\n"), HasSubstr("vertex index 0.5"));
  EXPECT_THAT(error(kHeader + "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n"), HasSubstr("length of a list"));
  EXPECT_THAT(error(kHeader + "0 0 0\n1 0 0\n0 1 0\n"), HasSubstr("ends early"));
}

TEST(Ply, NanInABinaryVertexIsAnError) {
  PlyWriter ply(PlyEncoding::kLittleEndian);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float value : {0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, nan, 0.0f}) ply.put(value);
  ply.put(std::uint8_t(3));
  for (const std::int32_t i : {0, 1, 2}) ply.put(i);
  const std::string header = kHeader.substr(kHeader.find("element"));
  EXPECT_THAT(error(ply.file(header.substr(0, header.find("end_header")))),
              HasSubstr("m.ply: error: vertex 2: y is nan, not a finite number"));
}

TEST(Ply, HeaderErrors) {
  EXPECT_THAT(error(""), HasSubstr("starts with the line 'ply'"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\n"), HasSubstr("ends inside its header"));
  EXPECT_THAT(error("ply\nformat ascii 2.0\nend_header\n"), HasSubstr("m.ply:2:1: error: a format is"));
  EXPECT_THAT(error("ply\nelement vertex 0\nend_header\n"), HasSubstr("no 'format'"));
  EXPECT_THAT(error("ply\nfromat ascii 1.0\nend_header\n"), HasSubstr("did you mean 'format'?"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nproperty float x\nend_header\n"),
              HasSubstr("must follow an element"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nelement vertex x\nend_header\n"),
              HasSubstr("'x' is not an integer"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nelement vertex 1\nproperty flaot x\nend_header\n"),
              HasSubstr("type is one of"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nelement face 1\nproperty float x\nend_header\n"),
              HasSubstr("the element vertex"));
  std::string no_z = kHeader;
  no_z.replace(no_z.find("float z"), 7, "float w");
  EXPECT_THAT(error(no_z), HasSubstr("must have x, y and z"));
  std::string no_list = kHeader;
  no_list.replace(no_list.find("vertex_indices"), 14, "corner_indices");
  EXPECT_THAT(error(no_list), HasSubstr("vertex_indices"));
}

TEST(Ply, LinesOfTheHeaderMayEndInCarriageReturns) {
  for (const std::string end : {"\r", "\r\n"}) {
    std::string text = kHeader;
    for (std::size_t at = 0; (at = text.find('\n', at)) != text.npos; at += end.size())
      text.replace(at, 1, end);
    const auto mesh = read(text + "0 0 0\r1 0 0\r0 1 0\r3 0 1 2\r");
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_THAT(mesh->triangles, ElementsAre(glm::uvec3(0, 1, 2)));
  }
  // The first byte of the body is no part of the header.
  std::string header =
      "ply\rformat binary_little_endian 1.0\relement vertex 1\rproperty float x\rproperty float y\r"
      "property float z\rend_header\r";
  const float first = std::bit_cast<float>(0x3F80000Au);  // its first byte is a line feed
  for (const float value : {first, 2.0f, 3.0f}) header.append(reinterpret_cast<const char*>(&value), 4);
  EXPECT_THAT(read(header).value().positions, ElementsAre(glm::dvec3(first, 2, 3)));
}

TEST(Ply, PointsAloneAreNoTriangles) {
  const auto file = read_ply({"m.ply",
                              "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                              "property float y\nproperty float z\nend_header\n1 2 3\n"});
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_THAT(file->mesh.triangles, SizeIs(0));
  EXPECT_THAT(file->warnings, ElementsAre("the file has points without faces, which are not shown"));
}

TEST(Ply, StripsOfTriangles) {
  std::string text = kHeader;
  text.replace(text.find("element vertex 3"), 16, "element vertex 5");
  text.replace(text.find("element face 1"), 14, "element tristrips 1");
  const auto mesh = read(text + "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 -1 2 3 4 -1\n");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_THAT(mesh->triangles, ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(1, 3, 2), glm::uvec3(2, 3, 4)));
  EXPECT_THAT(error(text + "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n3 0 1 5\n"), HasSubstr("out of range"));
}

TEST(Ply, ElementsWithoutPropertiesTakeNoTime) {
  std::string text = kHeader + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (int i = 0; i < 100; ++i) {
    text.insert(text.find("element vertex"), "element nothing" + std::to_string(i) + " 4294967295\n");
  }
  EXPECT_THAT(read(text).value().triangles, SizeIs(1));
}

TEST(Ply, OddFacesAreCountedByTheirNumbers) {
  std::string text = kHeader + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n1 1 .1\n3 0 1 2\n4 0 2 1 3\n4 0 1 4 3\n";
  text.replace(text.find("vertex 3"), 8, "vertex 5");
  text.replace(text.find("face 1"), 6, "face 3");
  const MeshFile file = read_ply({"m.ply", text}).value();
  EXPECT_EQ(file.faces.tangled.count, 1u);
  EXPECT_EQ(file.faces.tangled.first_name, "face 1");
  EXPECT_EQ(file.faces.warped.count, 1u);
  EXPECT_EQ(file.faces.warped.first_name, "face 2");
  // A corner of a unit square lifted by 0.1: the mean plane is 0.025 from all four.
  EXPECT_NEAR(file.faces.deviation, 0.025, 1e-4);
}

TEST(Ply, FacesThatCannotBeCut) {
  std::string vertices, face;
  int count = 0;
  for (; count < 20000; ++count) {  // a comb
    vertices += std::to_string(count) + (count % 2 == 0 ? " 0 0\n" : " 1 0\n");
    face += " " + std::to_string(count);
  }
  vertices += "10000 -1000000 0\n";
  std::string text = kHeader;
  text.replace(text.find("vertex 3"), 8, "vertex 20001");
  text.replace(text.find("uchar int"), 9, "int int");
  EXPECT_THAT(error(text + vertices + "20001" + face + " 20000\n"),
              HasSubstr("m.ply: error: face 0: a face of 20001 corners that is not convex"));
}

TEST(Ply, ElementsAreThereOnce) {
  std::string text = kHeader + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  text.insert(text.find("element face"), "element vertex 1\nproperty float x\n");
  EXPECT_THAT(error(text), HasSubstr("m.ply:7:1: error: the element 'vertex' is there twice"));
}

TEST(Ply, ACountThatTheFileCannotHoldIsAnErrorAtOnce) {
  std::string text = kHeader + "0 0 0\n";
  text.replace(text.find("vertex 3"), 8, "vertex 4000000000");
  EXPECT_THAT(error(text), HasSubstr("ends early: its header promises at least"));
  std::string list = kHeader + "0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n";
  EXPECT_THAT(error(list), HasSubstr("length of a list"));
}

}  // namespace
}  // namespace penumbra::mesh_ply_test
