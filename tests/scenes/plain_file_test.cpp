// Reading files with untrusted names.
#include "kernels/host/plain_file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

TEST(PlainFile, IsReadAsItIs) {
  const TemporaryFolder folder;
  const std::string text("a\0b\r\n\xff", 6);
  write_text(folder / "file", text);
  EXPECT_EQ(read_plain_file(folder / "file", 6).value(), text);
  write_text(folder / "empty", "");
  EXPECT_EQ(read_plain_file(folder / "empty", 0).value(), "");
}

TEST(PlainFile, WhatHasNoEndOrIsTooLargeIsRefused) {
  const TemporaryFolder folder;
  const auto why = [](const std::filesystem::path& file, std::uint64_t most) {
    const Expected<std::string> text = read_plain_file(file, most);
    return text ? "read" : text.error().message;
  };
  EXPECT_THAT(why("/dev/zero", 1 << 20), HasSubstr("'/dev/zero' is not a plain file"));
  EXPECT_THAT(why(folder.path(), 1 << 20), HasSubstr("is not a plain file"));
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(why(folder / "pipe", 1 << 20), HasSubstr("is not a plain file"))
      << "and reading does not wait for a writer";
  EXPECT_THAT(why(folder / "none", 1 << 20), HasSubstr("there is no file"));
  write_text(folder / "sparse", "");
  std::filesystem::resize_file(folder / "sparse", std::uintmax_t(1) << 40);
  EXPECT_THAT(why(folder / "sparse", 1 << 20), HasSubstr("the most that is read is 1048576"));
}

}  // namespace
}  // namespace penumbra
