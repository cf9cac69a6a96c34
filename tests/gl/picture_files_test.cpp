#include "gl/picture_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>

#include "tests/gl/hidden_window.h"
#include "tests/gl/random_film.h"

namespace penumbra::picture_files_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr int kWidth = 19, kHeight = 11;

class PictureFilesTest : public HiddenWindowTest {
 protected:
  void SetUp() override {
    HiddenWindowTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("picture_files_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    auto film = FilmTextures::create(kWidth, kHeight);
    auto pass = CompositePass::create();
    ASSERT_TRUE(film.has_value() && pass.has_value());
    film_ = std::make_unique<FilmTextures>(std::move(*film));
    pass_ = std::make_unique<CompositePass>(std::move(*pass));
    tile_ = random_tile(0, 0, kWidth, kHeight, 1, 32);
    tile_.view = 3;
    tile_.radiance[5] = std::numeric_limits<float>::infinity();
    tile_.difference[7] = 1e-42f;  // denormal
    tile_.standard_error[2] = std::numeric_limits<float>::quiet_NaN();
    ASSERT_TRUE(film_->apply(tile_));
    status_.scene = "a.xml";
    status_.spp_done = 32;
  }
  void TearDown() override {
    std::filesystem::remove_all(folder_);
    film_.reset();
    pass_.reset();
    HiddenWindowTest::TearDown();
  }
  Picture captured(const DisplaySettings& settings, const AnalyticTextures& analytic) {
    const auto compose_shown = [&] { return pass_->compose(*film_, analytic, settings); };
    auto picture = capture_picture(*pass_, *film_, analytic, compose_shown, settings, status_);
    EXPECT_TRUE(picture.has_value());
    return picture ? std::move(*picture) : Picture{};
  }
  Image saved(const std::string& name, const Picture& picture) {
    const auto done = save_picture(folder_ / name, picture);
    EXPECT_TRUE(done.has_value()) << done.error().message;
    auto image = read_image(folder_ / name);
    EXPECT_TRUE(image.has_value()) << image.error().message;
    return image.value_or(Image{});
  }
  static std::vector<std::uint32_t> channel_bits(const Image& image, const std::string& name) {
    std::vector<std::uint32_t> bits;
    const auto channel = image.channel(name);
    EXPECT_TRUE(channel.has_value()) << name;
    if (!channel) return bits;
    for (std::size_t i = *channel; i < image.values.size(); i += image.channels.size())
      bits.push_back(std::bit_cast<std::uint32_t>(image.values[i]));
    return bits;
  }
  static std::vector<std::uint32_t> plane_bits(const std::vector<float>& values, std::size_t first,
                                               std::size_t step) {
    std::vector<std::uint32_t> bits;
    for (std::size_t i = first; i < values.size(); i += step)
      bits.push_back(std::bit_cast<std::uint32_t>(values[i]));
    return bits;
  }

  std::filesystem::path folder_;
  std::unique_ptr<FilmTextures> film_;
  std::unique_ptr<CompositePass> pass_;
  TileSnapshot tile_;
  ViewStatus status_;
};

TEST_F(PictureFilesTest, AnExrHoldsTheFloatsThatCameBitForBit) {
  const Image image = saved("a.EXR", captured({}, {}));
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string channel(1, "RGB"[c]);
    EXPECT_EQ(channel_bits(image, channel), plane_bits(tile_.radiance, c, 3));
    EXPECT_EQ(channel_bits(image, "difference." + channel), plane_bits(tile_.difference, c, 3));
  }
  EXPECT_EQ(channel_bits(image, "standard_error.Y"), plane_bits(tile_.standard_error, 0, 1));
  EXPECT_EQ(channel_bits(image, "samples.Y"), plane_bits(std::vector<float>(kWidth * kHeight, 32.0f), 0, 1));
  EXPECT_FALSE(image.channel("analytic.R").has_value());
  EXPECT_EQ(image.attribute("penumbra:scene"), MetadataValue("a.xml"));
  EXPECT_EQ(image.attribute("penumbra:view"), MetadataValue(3));
  EXPECT_EQ(image.attribute("penumbra:spp"), MetadataValue(32));
  EXPECT_EQ(image.attribute("penumbra:incomplete"), MetadataValue(1));
  EXPECT_FALSE(image.attribute("penumbra:alpha").has_value());
}

TEST_F(PictureFilesTest, AHybridsExrHoldsTheImageWhateverLayerIsShown) {
  const auto g = random_floats(3 * kWidth * kHeight, 0, 2, 50),
             e = random_floats(3 * kWidth * kHeight, 0, 1, 60);
  const Texture g_texture = texture_of(g, kWidth, kHeight), e_texture = texture_of(e, kWidth, kHeight);
  const Picture picture =
      captured({.layer = Layer::kDifference, .alpha = 0.25f}, {g_texture.name(), e_texture.name()});
  const Image image = saved("a.exr", picture);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string channel(1, "RGB"[c]);
    EXPECT_EQ(channel_bits(image, "analytic." + channel), plane_bits(g, c, 3));
    const auto index = image.channel(channel);
    ASSERT_TRUE(index.has_value());
    for (std::size_t i = 0; i < image.pixels(); ++i) {
      const double gi = double(g[3 * i + c]), di = double(tile_.difference[3 * i + c]),
                   ei = double(e[3 * i + c]);
      ASSERT_NEAR(double(image.values[i * image.channels.size() + *index]), 0.25 * gi + di + ei,
                  3.0 / (1 << 23) * (gi + std::abs(di) + ei));
    }
  }
  EXPECT_EQ(image.attribute("penumbra:alpha"), MetadataValue(0.25f));
  EXPECT_NEAR(pass_->read_linear()[0], tile_.difference[0], 0) << "the shown layer is the composed one again";
}

TEST_F(PictureFilesTest, APngIsWhatIsShown) {
  const Picture picture = captured({.tone_map = ToneOperator::kAces, .exposure = 1}, {});
  const Image image = saved("a.png", picture);
  ASSERT_EQ(image.values.size(), picture.display.size());
  for (std::size_t i = 0; i < image.values.size(); ++i)
    ASSERT_EQ(std::lround(255 * image.values[i]), picture.display[i]) << i;
}

TEST_F(PictureFilesTest, OtherExtensionsAreRefusedWithTheRightOnes) {
  for (const char* name : {"a.jpg", "a", "a.exr.txt"}) {
    const auto done = save_picture(folder_ / name, captured({}, {}));
    ASSERT_FALSE(done.has_value());
    EXPECT_THAT(done.error().message, AllOf(HasSubstr(name), HasSubstr(".exr"), HasSubstr(".png")));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(PictureFilesTest, MissingFoldersAreMade) {
  EXPECT_TRUE(save_picture(folder_ / "missing" / "a.exr", captured({}, {})).has_value());
  EXPECT_TRUE(std::filesystem::exists(folder_ / "missing" / "a.exr"));
}

TEST_F(PictureFilesTest, DamagedPicturesAreErrors) {
  Picture picture = captured({}, {});
  picture.difference.pop_back();
  picture.display.pop_back();
  EXPECT_FALSE(save_picture(folder_ / "a.exr", picture).has_value());
  EXPECT_FALSE(save_picture(folder_ / "a.png", picture).has_value());
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

}  // namespace
}  // namespace penumbra::picture_files_test
