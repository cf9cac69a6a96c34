// Names of files with a field for the frame.
#include "scheduler/render/frame_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(FrameFiles, AllWaysToWriteTheFieldMeanTheSame) {
  for (const char* name : {"out/shot.####.exr", "out/shot.{frame:04}.exr", "out/shot.%04d.exr"}) {
    const auto files = FrameFiles::of(name);
    ASSERT_TRUE(files.has_value()) << name;
    EXPECT_EQ(files->file(7), "out/shot.0007.exr");
    EXPECT_EQ(files->file(12345), "out/shot.12345.exr");
    EXPECT_EQ(files->folder(), "out/");
    EXPECT_EQ(files->without_field(), "out/shot.exr");
  }
  for (const char* name : {"a#.png", "a{frame}.png", "a%d.png"}) {
    const auto files = FrameFiles::of(name);
    ASSERT_TRUE(files.has_value()) << name;
    EXPECT_EQ(files->file(7), "a7.png");
    EXPECT_EQ(files->folder(), ".");
  }
}

TEST(FrameFiles, OtherNamesHaveNoField) {
  for (const char* name : {"shot.0001.exr", "50%.exr", "a%4d.png", "{frame:x}.exr", "{frames}.exr",
                           "{seed}.exr", "a%04x.png", ""})
    EXPECT_FALSE(FrameFiles::of(name).has_value()) << name;
}

TEST(FrameFiles, TheFrameOfAFileIsThatWhichGivesItsName) {
  const auto files = FrameFiles::of("out/shot.####.exr").value();
  EXPECT_EQ(files.frame_of("out/shot.0012.exr"), 12);
  EXPECT_EQ(files.frame_of("out/shot.12345.exr"), 12345);
  for (const char* other : {"out/shot.012.exr", "out/shot.00012.exr", "out/shot.0012.png", "shot.0012.exr",
                            "out/shot..exr", "out/shot.-012.exr", "out/shot.0012-denoised.exr",
                            "out/shot.exr", "out/shot.99999999999999999999.exr"})
    EXPECT_FALSE(files.frame_of(other).has_value()) << other;
}

TEST(FrameFiles, FindsFilesAndFolders) {
  const TemporaryFolder folder;
  for (const char* name :
       {"a.0003.exr", "a.0001.exr", "a.0010.exr", "a.10000.exr", "a.0002.png", "b.0002.exr", "a.2.exr"})
    write_text(folder.path() / name, "");
  std::filesystem::create_directories(folder.path() / "a.0004.exr");
  std::filesystem::create_directories(folder.path() / "f007");
  std::filesystem::create_directories(folder.path() / "f008");
  write_text(folder.path() / "f007" / "beauty.exr", "");
  const auto find = [&](const char* name) { return FrameFiles::of((folder.path() / name).string())->find(); };
  EXPECT_THAT(find("a.####.exr"), ElementsAre(1, 3, 10, 10000));
  EXPECT_THAT(find("f###/beauty.exr"), ElementsAre(7));
  EXPECT_THAT(find("c.####.exr"), IsEmpty());
  EXPECT_THAT(find("nowhere/a.####.exr"), IsEmpty());
}

TEST(FrameFiles, WithoutTheFieldTheNameIsThatOfTheShot) {
  const auto name = [](const char* text) { return FrameFiles::of(text)->without_field(); };
  EXPECT_EQ(name("shot-####-x.exr"), "shot-x.exr");
  EXPECT_EQ(name("shot####.exr"), "shot.exr");
  EXPECT_EQ(name("out/####_beauty.exr"), "out/beauty.exr");
  EXPECT_EQ(name("out/####/beauty.exr"), "out/beauty.exr");
}

TEST(FrameFiles, FieldsBecomeHashes) {
  EXPECT_EQ(with_hashes("{folder}/{scene}.{frame:04}.exr"), "{folder}/{scene}.####.exr");
  EXPECT_EQ(with_hashes("{frame}/a{frame:02}.exr"), "#/a##.exr");
}

}  // namespace
}  // namespace penumbra
