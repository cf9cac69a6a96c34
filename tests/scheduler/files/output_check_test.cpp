#include "scheduler/files/output_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;

std::string complaint(const std::vector<std::filesystem::path>& outputs,
                      const std::vector<std::filesystem::path>& inputs) {
  const auto checked = check_outputs(outputs, inputs);
  return checked ? "" : checked.error().message;
}

TEST(OutputCheck, InputsAreKnownByAnyName) {
  const TemporaryFolder folder;
  write_text(folder / "in", "scene");
  std::filesystem::create_hard_link(folder / "in", folder / "hard");
  std::filesystem::create_symlink("in", folder / "soft");
  std::filesystem::create_directory(folder / "sub");
  for (const char* name : {"in", "hard", "soft", "sub/../in", "./in"})
    EXPECT_THAT(complaint({folder / name}, {folder / "in"}), HasSubstr("is an input")) << name;
  EXPECT_EQ(complaint({folder / "out"}, {folder / "in"}), "");
}

TEST(OutputCheck, TwoOutputsAreNotOneFile) {
  const TemporaryFolder folder;
  write_text(folder / "old", "x");
  std::filesystem::create_hard_link(folder / "old", folder / "hard");
  std::filesystem::create_symlink("new", folder / "soft");
  EXPECT_THAT(complaint({folder / "old", folder / "hard"}, {}), HasSubstr("two outputs in one file"));
  EXPECT_THAT(complaint({folder / "new", folder / "soft"}, {}), HasSubstr("two outputs in one file"));
  EXPECT_THAT(complaint({folder / "a/b", folder / "a/../a/b"}, {}), HasSubstr("two outputs in one file"));
  EXPECT_EQ(complaint({folder / "a", folder / "b"}, {}), "");
  EXPECT_EQ(complaint({"/dev/null", "/dev/null"}, {}), "");
  EXPECT_FALSE(identity_of_output("/dev/null"));
  EXPECT_EQ(identity_of_output(folder / "old"), identity_of_output(folder / "hard"));
}

}  // namespace
}  // namespace penumbra
