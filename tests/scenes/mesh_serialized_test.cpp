#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "scenes/mesh_reader.h"
#include "tests/scenes/scene_text.h"
#include "tests/scenes/serialized_writer.h"

namespace penumbra::mesh_serialized_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Expected<MeshFile> read(std::string bytes, std::int64_t index = 0) {
  return read_serialized({"m.serialized", std::move(bytes)}, index);
}

std::string error(std::string bytes, std::int64_t index = 0) {
  const auto mesh = read(std::move(bytes), index);
  EXPECT_FALSE(mesh);
  return mesh ? "" : mesh.error().message;
}

void expect_same(const Mesh& read_back, const Mesh& mesh) {
  EXPECT_EQ(read_back.positions, mesh.positions);
  EXPECT_EQ(read_back.normals, mesh.normals);
  EXPECT_EQ(read_back.texcoords, mesh.texcoords);
  EXPECT_EQ(read_back.colours, mesh.colours);
  EXPECT_EQ(read_back.triangles, mesh.triangles);
}

class SerializedVersions : public ::testing::TestWithParam<int> {};

/// Every set of attributes, precision and flag in one file, found by its index.
TEST_P(SerializedVersions, GiveBackEveryMesh) {
  std::vector<Mesh> meshes;
  std::vector<SerializedOptions> options;
  SerializedWriter writer(GetParam());
  for (int bits = 0; bits < 64; ++bits) {
    Mesh mesh = serialized_square(0.25 * bits);
    if ((bits & 1) == 0) mesh.normals.clear();
    if ((bits & 2) == 0) mesh.texcoords.clear();
    if ((bits & 4) == 0) mesh.colours.clear();
    const SerializedOptions these = {GetParam(), (bits & 8) != 0, (bits & 16) != 0, (bits & 32) != 0};
    writer.add(mesh, these);
    meshes.push_back(std::move(mesh));
    options.push_back(these);
  }
  const std::string file = writer.file();
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    SCOPED_TRACE(i);
    const auto back = read(file, std::int64_t(i));
    ASSERT_TRUE(back) << back.error().message;
    expect_same(back->mesh, meshes[i]);
    EXPECT_EQ(back->face_normals, options[i].face_normals);
  }
  EXPECT_THAT(error(file, 64), HasSubstr("there is no mesh 64: the file has 64, counted from 0"));
}

/// Positions of double precision are not rounded.
TEST_P(SerializedVersions, KeepDoublePrecision) {
  SerializedWriter writer(GetParam());
  Mesh mesh = serialized_square(1.0 / 3);
  writer.add(mesh, {GetParam(), true});
  EXPECT_EQ(read(writer.file())->mesh.positions[3].x, 1.0 / 3);
}

TEST_P(SerializedVersions, MeshesLargerThanWhatIsReadAtOnce) {
  Mesh mesh;
  constexpr std::uint32_t kVertices = 1'100'000;
  for (std::uint32_t i = 0; i < kVertices; ++i) {
    mesh.positions.emplace_back(i % 1024, i / 1024, 0.5 * (i % 3));
    if (i >= 2) mesh.triangles.emplace_back(i - 2, i - 1, i);
  }
  SerializedWriter writer(GetParam());
  writer.add(mesh, {GetParam()});
  const auto back = read(writer.file());
  ASSERT_TRUE(back) << back.error().message;
  expect_same(back->mesh, mesh);
}

TEST_P(SerializedVersions, TruncatedAnywhereIsAnError) {
  SerializedWriter writer(GetParam());
  writer.add(serialized_square(0), {GetParam()});
  writer.add(serialized_square(1), {GetParam()});
  const std::string whole = writer.file();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string cut = whole.substr(0, size);
    ASSERT_THAT(error(cut, 1), HasSubstr("m.serialized: error: ")) << "cut to " << size;
  }
}

INSTANTIATE_TEST_SUITE_P(All, SerializedVersions, ::testing::Values(3, 4));

class SerializedErrors : public ::testing::Test {
 protected:
  template <typename... Numbers>
  std::string of_stream(const Numbers&... numbers) {
    SerializedWriter writer(3);
    std::string data;
    (SerializedWriter::put(data, numbers), ...);
    writer.add_packed(data);
    return error(writer.file());
  }
};

TEST_F(SerializedErrors, SayWhatIsWrong) {
  EXPECT_THAT(error(""), HasSubstr("the file ends early: there is no room for a header"));
  EXPECT_THAT(error("ply\nformat ascii"), HasSubstr("it does not start with 0x041c"));
  EXPECT_THAT(error(std::string("\x1c\x04\x02\x00", 4)), HasSubstr("version 2 of the format is not one"));
  EXPECT_THAT(error(std::string("\x1c\x04\x04\x00zzzz", 8)), HasSubstr("the compressed data are damaged"));
  EXPECT_THAT(error(std::string("\x1c\x04\x04\x00", 4)), HasSubstr("mesh 0: the data end early"));
  EXPECT_THAT(of_stream(0u, std::uint64_t(1) << 40, std::uint64_t(1)),
              HasSubstr("promises 1099511627776 vertices and 1 triangles, which its"));
  EXPECT_THAT(of_stream(0u, std::uint64_t(1), std::uint64_t(1), 0.0f, 0.0f, 0.0f, 0u, 0u, 1u),
              HasSubstr("triangle 0: vertex index 1 is out of range: there are 1 vertices"));
  EXPECT_THAT(
      of_stream(0u, std::uint64_t(1), std::uint64_t(1), 0.0f, std::numeric_limits<float>::infinity(), 0.0f),
      HasSubstr("the position of vertex 0 has inf, not a finite number"));
  EXPECT_THAT(of_stream(0x2000u, std::uint64_t(1), std::uint64_t(1), 0.0, 0.0),
              HasSubstr("the data end early"));
}

TEST_F(SerializedErrors, OfTheTableOfMeshes) {
  SerializedWriter writer(4);
  writer.add(serialized_square(0), {});
  std::string file = writer.file();
  EXPECT_THAT(error(file, -1), HasSubstr("meshes are counted from 0"));
  std::string many = file;
  many.replace(many.size() - 4, 4, "\xff\xff\xff\x7f");
  EXPECT_THAT(error(many, 1), HasSubstr("table of meshes, at its end, does not fit"));
  SerializedWriter two(4);
  two.add(serialized_square(0), {});
  two.add(serialized_square(1), {});
  std::string astray = two.file();
  astray[astray.size() - 12] = 9;
  EXPECT_THAT(error(astray, 1), HasSubstr("no mesh starts at byte"));
  astray[astray.size() - 6] = 9;
  EXPECT_THAT(error(astray, 1), HasSubstr("mesh 1 would start at byte"));
}

class SerializedShapes : public SceneText {};

TEST_F(SerializedShapes, AreMeshesOfTheScene) {
  SerializedWriter writer(4);
  writer.add(serialized_square(0), {});
  writer.add(serialized_square(1), {});
  SerializedOptions flat;
  flat.face_normals = true;
  writer.add(serialized_square(2), flat);
  write("m.serialized", writer.file());
  const std::string shape = "<shape type='serialized'><string name='filename' value='m.serialized'/>";
  const SceneDescription s = good(
      shape + "</shape>" + shape + "<integer name='shapeIndex' value='1'/><transform name='toWorld'>" +
      "<translate x='3'/></transform></shape>" + shape + "<integer name='shape_index' value='2'/></shape>");
  ASSERT_EQ(s.shapes.size(), 3u);
  EXPECT_EQ(std::get<Mesh>(s.shapes[0].geometry).positions[3].x, 0.0);
  EXPECT_EQ(std::get<Mesh>(s.shapes[0].geometry).normals.size(), 4u);
  EXPECT_EQ(std::get<Mesh>(s.shapes[1].geometry).positions[3].x, 4.0);
  EXPECT_TRUE(std::get<Mesh>(s.shapes[2].geometry).normals.empty()) << "the file wants face normals";
  EXPECT_THAT(SceneText::error(scene(shape + "<integer name='shape_index' value='3'/></shape>")),
              AllOf(HasSubstr("m.serialized: error: there is no mesh 3: the file has 3"),
                    HasSubstr("named at scene.xml:2:")));
}

}  // namespace
}  // namespace penumbra::mesh_serialized_test
