// Tests `penumbra convert` and the files that it writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::convert_command_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kMesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
constexpr const char* kScene =
    "<scene version='3.0.0'><shape type='obj'><string name='filename' value='a.obj'/></shape>"
    "<shape type='ply'><string name='filename' value='s-1.ply'/></shape><emitter type='constant'/>"
    "<sensor type='perspective'/></scene>";
constexpr const char* kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

class ConvertCommand : public ::testing::Test {
 protected:
  ConvertCommand() {
    write_text(folder_ / "a.obj", kMesh);
    write_text(folder_ / "s-1.ply", kPly);
    write_text(folder_ / "s.xml", kScene);
  }
  ProgramResult convert(const std::string& output) {
    return run_penumbra(folder_.path(), {"convert", "s.xml", output});
  }
  TemporaryFolder folder_;
};

TEST_F(ConvertCommand, WritesTheSceneAndItsMeshesBesideIt) {
  const ProgramResult done = convert("new/t.xml");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(run_penumbra(folder_ / "new", {"info", "t.xml"}).exit_code, 0);
  EXPECT_THAT(folder_.names(), ElementsAre("a.obj", "new", "s-1.ply", "s.xml"));
}

TEST_F(ConvertCommand, WhatCannotBeWrittenIsSaidAndLeavesNothing) {
  const std::vector<std::string> before = folder_.names();
  for (const auto& [output, why] : {std::pair("out.obj", "'out.obj' does not end in .xml"),
                                    std::pair("new/out", "'new/out' does not end in .xml"),
                                    std::pair("new/", "'new/' does not end in .xml"),
                                    std::pair("a.obj/new/t.xml", "a.obj/new is not a folder")}) {
    const ProgramResult done = convert(output);
    EXPECT_NE(done.exit_code, 0) << output;
    EXPECT_THAT(done.err, HasSubstr(why));
    EXPECT_EQ(folder_.names(), before) << output;
  }
}

TEST_F(ConvertCommand, InputsAreNeverOutputs) {
  std::filesystem::create_symlink("s.xml", folder_ / "link.xml");
  for (const auto& [output, input] : {std::pair("s.xml", "s-1.ply"), std::pair("link.xml", "link.xml"),
                                      std::pair("./s.XML", "s-1.ply"), std::pair("s.again.xml", "")}) {
    const ProgramResult done = convert(output);
    if (*input == '\0') {  // whose meshes have other names
      EXPECT_EQ(done.exit_code, 0) << done.err;
      continue;
    }
    EXPECT_EQ(done.exit_code, 2);
    EXPECT_THAT(done.err, HasSubstr(std::string(input) + " is an input of this command"));
    EXPECT_EQ(file_contents(folder_ / "s.xml"), kScene);
    EXPECT_EQ(file_contents(folder_ / "s-1.ply"), kPly);
  }
}

TEST_F(ConvertCommand, WhatIsProtectedOrCannotBeWrittenStaysAsItIs) {
  write_text(folder_ / "t.xml", "old");
  chmod((folder_ / "t.xml").c_str(), 0444);
  const ProgramResult protected_file = convert("t.xml");
  EXPECT_EQ(protected_file.exit_code, 2);
  EXPECT_THAT(protected_file.err, HasSubstr("t.xml: it is write-protected"));
  EXPECT_EQ(file_contents(folder_ / "t.xml"), "old");

  // Of two meshes and a scene all are written or none.
  write_text(folder_ / "u.xml", "old");
  std::filesystem::create_directory(folder_ / "u-1.ply");
  EXPECT_EQ(convert("u.xml").exit_code, 2);
  EXPECT_EQ(file_contents(folder_ / "u.xml"), "old");
  EXPECT_THAT(folder_.names(), ElementsAre("a.obj", "s-1.ply", "s.xml", "t.xml", "u-1.ply", "u.xml"));
  EXPECT_EQ(convert("a.obj/t.xml").exit_code, 2) << "no folder can be made there";
}

/// A rectangle with an image.
std::string gltf_with(const std::string& uri) {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0, "name": "a.picture"}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1},
"indices": 2, "material": 0}]}], "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
"metallicFactor": 0}}], "textures": [{"source": 0}], "images": [{"uri": ")" +
         uri +
         R"("}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
{"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
{"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 32},
{"buffer": 0, "byteOffset": 80, "byteLength": 12}], "buffers": [{"byteLength": 92, "uri": "data:application/octet-stream;base64,)"
         "AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgD8AAAAAAAAAAAAAgD8AAIA/"
         "AACAPwAAgD8AAAAAAAAAAAAAAAAAAAEA"
         "AgAAAAIAAwA=\"}]}";
}

/// What is converted may be moved with the images that it names, and read from anywhere.
TEST_F(ConvertCommand, ImagesAreFoundFromTheOutputsFolder) {
  const std::string encoded =
      "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC";
  std::filesystem::create_directory(folder_ / "sub");
  write_text(folder_ / "sub/embedded.gltf", gltf_with("data:image/png;base64," + encoded));
  const auto converted = [&](const std::string& from, const std::string& to) {
    const ProgramResult done = run_penumbra(folder_.path(), {"convert", from, to});
    EXPECT_EQ(done.exit_code, 0) << done.err;
    const std::filesystem::path other = folder_ / "elsewhere";
    std::filesystem::create_directory(other);
    const ProgramResult info = run_penumbra(other, {"info", "../" + to});
    EXPECT_EQ(info.exit_code, 0) << info.err;
    return file_contents(folder_ / to);
  };
  EXPECT_THAT(converted("sub/embedded.gltf", "out/a.xml"),
              AllOf(HasSubstr("value=\"a-0.png\""), HasSubstr("id=\"a_picture\"")));
  std::filesystem::rename(folder_ / "out/a-0.png", folder_ / "sub/red.png");
  write_text(folder_ / "sub/named.gltf", gltf_with("red.png"));
  EXPECT_THAT(converted("sub/named.gltf", "b.xml"), HasSubstr("value=\"sub/red.png\""));
  EXPECT_THAT(converted("sub/named.gltf", "out/c.xml"), HasSubstr("value=\"../sub/red.png\""));
  std::filesystem::rename(folder_.path() / "out", folder_.path() / "moved");
  EXPECT_EQ(run_penumbra(folder_ / "moved", {"info", "c.xml"}).exit_code, 0);
}

TEST_F(ConvertCommand, IdsStay) {
  write_text(
      folder_ / "ids.xml",
      "<scene version='3.0.0'><bsdf type='diffuse' id='paint'/><shape type='sphere' id='ball'><ref "
      "id='paint'/></shape>"
      "<shape type='disk' id='plate'><bsdf type='plastic' id='medium-0'/></shape><shape type='sphere'/>"
      "<emitter type='constant'/><sensor type='perspective'/></scene>");
  ASSERT_EQ(run_penumbra(folder_.path(), {"convert", "ids.xml", "t.xml"}).exit_code, 0);
  const std::string text = file_contents(folder_ / "t.xml");
  for (const char* id : {"\"paint\"", "\"ball\"", "\"plate\""}) EXPECT_THAT(text, HasSubstr(id));
  ASSERT_EQ(run_penumbra(folder_.path(), {"convert", "t.xml", "u.xml"}).exit_code, 0);
  EXPECT_EQ(file_contents(folder_ / "u.xml"), text);
}

}  // namespace
}  // namespace penumbra::convert_command_test
