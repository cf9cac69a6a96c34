#include "gl/film_textures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "tests/gl/hidden_window.h"
#include "tests/gl/random_film.h"

namespace penumbra::film_textures_test {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 37, kHeight = 23;

std::vector<std::uint32_t> bits(std::span<const float> values) {
  std::vector<std::uint32_t> result;
  for (const float value : values) result.push_back(std::bit_cast<std::uint32_t>(value));
  return result;
}

std::vector<float> downloaded(GLuint texture, GLenum format, std::size_t channels) {
  std::vector<float> values(channels * kWidth * kHeight);
  glBindTexture(GL_TEXTURE_2D, texture);
  glGetTexImage(GL_TEXTURE_2D, 0, format, GL_FLOAT, values.data());
  return values;
}

class FilmTexturesTest : public HiddenWindowTest {
 protected:
  void SetUp() override {
    HiddenWindowTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    auto film = FilmTextures::create(kWidth, kHeight);
    ASSERT_TRUE(film.has_value()) << film.error().message;
    film_ = std::make_unique<FilmTextures>(std::move(*film));
  }
  void TearDown() override {
    film_.reset();
    HiddenWindowTest::TearDown();
  }
  void expect_same_on_the_device() {
    EXPECT_EQ(bits(downloaded(film_->radiance_texture(), GL_RGBA, 4)), bits(film_->radiance()));
    EXPECT_EQ(bits(downloaded(film_->difference_texture(), GL_RGB, 3)), bits(film_->difference()));
    EXPECT_EQ(bits(downloaded(film_->standard_error_texture(), GL_RED, 1)), bits(film_->standard_error()));
  }
  std::vector<std::uint32_t> everything() const {
    std::vector<std::uint32_t> all = bits(film_->radiance());
    for (const auto plane : {film_->difference(), film_->standard_error()}) {
      const auto more = bits(plane);
      all.insert(all.end(), more.begin(), more.end());
    }
    return all;
  }

  std::unique_ptr<FilmTextures> film_;
};

TEST_F(FilmTexturesTest, BeginsWithoutSamples) {
  for (std::size_t i = 0; i < kWidth * kHeight; ++i) {
    ASSERT_EQ(film_->radiance()[4 * i + 3], 0.0f);
    ASSERT_TRUE(std::isnan(film_->standard_error()[i]));
  }
  EXPECT_FALSE(film_->has_difference());
  expect_same_on_the_device();
}

TEST_F(FilmTexturesTest, ATileChangesItsPixelsAndNoOthers) {
  TileSnapshot tile = random_tile(30, 7, 7, 16, 1, 40);  // to the film's corner
  tile.standard_error[3] = std::numeric_limits<float>::quiet_NaN();
  tile.radiance[4] = std::numeric_limits<float>::infinity();
  tile.difference[5] = 1e-42f;  // denormal
  ASSERT_TRUE(film_->apply(tile));
  EXPECT_TRUE(film_->has_difference());
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const std::size_t pixel = std::size_t(y) * kWidth + std::size_t(x);
      const bool inside = x >= 30 && y >= 7;
      ASSERT_EQ(film_->radiance()[4 * pixel + 3], inside ? 40.0f : 0.0f) << x << ", " << y;
      if (!inside) continue;
      const std::size_t from = std::size_t(y - 7) * 7 + std::size_t(x - 30);
      ASSERT_EQ(bits(film_->radiance().subspan(4 * pixel, 3)),
                bits(std::span(tile.radiance).subspan(3 * from, 3)));
      ASSERT_EQ(bits(film_->difference().subspan(3 * pixel, 3)),
                bits(std::span(tile.difference).subspan(3 * from, 3)));
      ASSERT_EQ(bits(film_->standard_error().subspan(pixel, 1)),
                bits(std::span(tile.standard_error).subspan(from, 1)));
    }
  }
  expect_same_on_the_device();
}

TEST_F(FilmTexturesTest, ALaterSnapshotReplacesAnEarlierOne) {
  ASSERT_TRUE(film_->apply(random_tile(0, 0, 8, 8, 1)));
  TileSnapshot later = random_tile(0, 0, 8, 8, 10, 32);
  later.difference.clear();
  ASSERT_TRUE(film_->apply(later));
  EXPECT_EQ(film_->radiance()[0], later.radiance[0]);
  EXPECT_EQ(film_->radiance()[3], 32.0f);
  EXPECT_EQ(film_->difference()[0], 0.0f);
  expect_same_on_the_device();
}

TEST_F(FilmTexturesTest, WhatDoesNotFitChangesNothing) {
  ASSERT_TRUE(film_->apply(random_tile(0, 0, kWidth, kHeight, 1)));
  const auto before = everything();
  const std::vector<std::array<int, 4>> outside{
      {-1, 0, 8, 8},     {0, -1, 8, 8}, {30, 0, 8, 8}, {0, 16, 8, 8},
      {kWidth, 0, 1, 1}, {0, 0, 0, 8},  {0, 0, 8, 0},  {std::numeric_limits<int>::max(), 0, 1, 1}};
  for (const auto& [x, y, width, height] : outside)
    EXPECT_FALSE(film_->apply(random_tile(x, y, width, height, 5)))
        << x << " " << y << " " << width << " " << height;
  for (auto array : {&TileSnapshot::radiance, &TileSnapshot::difference, &TileSnapshot::standard_error}) {
    TileSnapshot damaged = random_tile(0, 0, 8, 8, 6);
    (damaged.*array).pop_back();
    EXPECT_FALSE(film_->apply(damaged));
  }
  EXPECT_EQ(everything(), before);
  expect_same_on_the_device();
}

TEST_F(FilmTexturesTest, TilesOfEarlierViewsAreLeftOutAndLaterOnesBeginAnew) {
  TileSnapshot tile = random_tile(0, 0, 8, 8, 1);
  film_->clear(3);
  tile.view = 2;
  EXPECT_FALSE(film_->apply(tile));
  EXPECT_EQ(film_->radiance()[3], 0.0f);
  tile.view = 3;
  EXPECT_TRUE(film_->apply(tile));
  TileSnapshot next = random_tile(16, 0, 8, 8, 2);
  next.view = 4;
  EXPECT_TRUE(film_->apply(next));
  EXPECT_EQ(film_->view(), 4u);
  EXPECT_EQ(film_->radiance()[3], 0.0f) << "the tile of view 3 is gone";
  EXPECT_EQ(film_->radiance()[4 * 16 + 3], 16.0f);
  film_->clear(5);
  EXPECT_FALSE(film_->has_difference());
  EXPECT_EQ(film_->radiance()[4 * 16 + 3], 0.0f);
  expect_same_on_the_device();
}

TEST_F(FilmTexturesTest, FilmsThatAreTooLargeNameTheLimit) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  const auto film = FilmTextures::create(limit + 1, 1);
  ASSERT_FALSE(film.has_value());
  EXPECT_THAT(film.error().message, HasSubstr(std::to_string(limit)));
  EXPECT_FALSE(FilmTextures::create(0, 5).has_value());
  EXPECT_TRUE(FilmTextures::create(limit, 1).has_value());
}

}  // namespace
}  // namespace penumbra::film_textures_test
