// `penumbra convert` and its files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::convert_command_test {
namespace {

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

}  // namespace
}  // namespace penumbra::convert_command_test
