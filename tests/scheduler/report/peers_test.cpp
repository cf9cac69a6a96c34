#include "scheduler/report/peers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernels/host/atomic_file.h"
#include "scheduler/image/image_files.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 3, kHeight = 2;

class Peers : public ::testing::Test {
 protected:
  void add_image(const std::string& name, int width = kWidth, int height = kHeight) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    const Image image{{0, 0, width, height},
                      {0, 0, width, height},
                      {"R", "G", "B"},
                      std::vector<float>(std::size_t(width) * std::size_t(height) * 3, 0.5f),
                      {}};
    ASSERT_TRUE(write_file_atomically(folder_ / name, *encode_exr(image)));
  }
  [[nodiscard]] std::string error() const {
    const auto peers = find_peers(folder_.path(), kWidth, kHeight);
    return peers ? "" : peers.error().message;
  }
  TemporaryFolder folder_;
};

TEST(PeerSeconds, AreReadFromTheName) {
  EXPECT_EQ(peer_seconds("0.35-seconds.exr"), 0.35);
  EXPECT_EQ(peer_seconds("004.25-seconds.exr"), 4.25);
  EXPECT_EQ(peer_seconds("12-seconds.exr"), 12);
  for (const char* bad :
       {"", "-seconds.exr", "x-seconds.exr", "1.exr", "0-seconds.exr", "-1-seconds.exr", "1s-seconds.exr",
        "1-seconds.png", "1-seconds.exr.tmp", "inf-seconds.exr", "nan-seconds.exr", "1e3-seconds.exr"})
    EXPECT_FALSE(peer_seconds(bad)) << bad;
}

TEST_F(Peers, AreSortedByNameAndTime) {
  add_image("b/10-seconds.exr");
  add_image("b/002.5-seconds.exr");
  add_image("a/1-seconds.exr");
  write_text(folder_ / ".hidden", "");
  const auto peers = find_peers(folder_.path(), kWidth, kHeight);
  ASSERT_TRUE(peers) << peers.error().message;
  ASSERT_EQ(peers->size(), 2u);
  EXPECT_EQ((*peers)[0].name, "a");
  ASSERT_EQ((*peers)[1].images.size(), 2u);
  EXPECT_EQ((*peers)[1].images[0].seconds, 2.5);
  EXPECT_EQ((*peers)[1].images[1].seconds, 10);
}

TEST_F(Peers, ErrorsNameTheFile) {
  EXPECT_THAT(error(), HasSubstr("holds no folders"));
  add_image("good/1-seconds.exr");
  EXPECT_EQ(error(), "");
  add_image("odd/image.exr");
  EXPECT_THAT(error(), HasSubstr("odd/image.exr is not named SECONDS-seconds.exr"));
}

TEST_F(Peers, SizeMustBeTheScenes) {
  add_image("large/1-seconds.exr", kWidth + 1, kHeight);
  EXPECT_THAT(error(), HasSubstr("1-seconds.exr has 4 x 2 pixels, the scene 3 x 2"));
}

TEST_F(Peers, OneTimeTwiceIsAnError) {
  add_image("a/1-seconds.exr");
  add_image("a/1.0-seconds.exr");
  EXPECT_THAT(error(), HasSubstr("same time"));
}

TEST_F(Peers, ImageMustBeReadable) {
  std::filesystem::create_directories(folder_ / "a");
  write_text(folder_ / "a/1-seconds.exr", "no image");
  EXPECT_THAT(error(), HasSubstr("1-seconds.exr"));
}

TEST_F(Peers, FolderMustBeThereAndHoldFolders) {
  EXPECT_FALSE(find_peers(folder_ / "missing", kWidth, kHeight));
  add_image("1-seconds.exr");
  EXPECT_THAT(error(), HasSubstr("is no folder"));
  std::filesystem::remove(folder_ / "1-seconds.exr");
  std::filesystem::create_directories(folder_ / "empty");
  EXPECT_THAT(error(), HasSubstr("holds no images"));
}

}  // namespace
}  // namespace penumbra
