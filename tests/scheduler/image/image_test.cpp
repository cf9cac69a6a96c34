#include "scheduler/image/image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernels/host/atomic_file.h"
#include "scheduler/image/image_files.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string read_error(const std::filesystem::path& path) {
  const auto image = read_image(path);
  return image ? "no error" : image.error().message;
}

TEST(ReadImage, NamesWhatIsMissing) {
  const TemporaryFolder folder;
  EXPECT_THAT(read_error(folder / "none.exr"), AllOf(HasSubstr("none.exr"), HasSubstr("no such file")));
  EXPECT_THAT(read_error(folder.path()), HasSubstr("is not a plain file"));
  write_text(folder / "text.exr", "this is no image");
  EXPECT_THAT(read_error(folder / "text.exr"), HasSubstr("cannot be read as an image"));
  write_text(folder / "empty.png", "");
  EXPECT_THAT(read_error(folder / "empty.png"), HasSubstr("cannot be read as an image"));
}

TEST(ReadImage, RefusesATruncatedExr) {
  Image image;
  image.data = image.display = {0, 0, 64, 64};
  image.channels = {"R", "G", "B"};
  for (std::size_t i = 0; i < image.pixels() * 3; ++i) image.values.push_back(float(i * 2654435761u % 1000));
  const auto bytes = encode_exr(image);
  ASSERT_TRUE(bytes);
  const TemporaryFolder folder;
  for (const double share : {0.01, 0.1, 0.5, 0.9}) {
    const auto part = std::span(*bytes).first(std::size_t(share * double(bytes->size())));
    ASSERT_TRUE(write_file_atomically(folder / "cut.exr", part));
    EXPECT_THAT(read_error(folder / "cut.exr"), HasSubstr("cannot be read as an image")) << share;
  }
}

TEST(Image, FindsTheBeautyLayer) {
  Image image;
  image.channels = {"albedo.R", "B", "G", "R"};
  EXPECT_EQ(image.beauty_channels(), (std::array<std::size_t, 3>{3, 2, 1}));
  image.channels = {"A", "Y"};
  EXPECT_EQ(image.beauty_channels(), (std::array<std::size_t, 3>{1, 1, 1}));
  image.channels = {"depth.Z"};
  EXPECT_EQ(image.beauty_channels(), (std::array<std::size_t, 3>{0, 0, 0}));
  image.channels = {"depth.Z", "albedo.R"};
  EXPECT_FALSE(image.beauty_channels());
}

}  // namespace
}  // namespace penumbra
