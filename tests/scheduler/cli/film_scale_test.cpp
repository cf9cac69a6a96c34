#include "scheduler/render/film_scale.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace penumbra {
namespace {

using ::testing::HasSubstr;

TEST(FilmScale, IsAPercentageOrAShare) {
  EXPECT_EQ(parse_scale("25%"), 0.25);
  EXPECT_EQ(parse_scale("0.25"), 0.25);
  EXPECT_EQ(parse_scale("33.3%"), 0.333);
  EXPECT_EQ(parse_scale("1"), 1);
  EXPECT_EQ(parse_scale("200%"), 2);
  EXPECT_EQ(parse_scale("0.1%"), 0.001);
  EXPECT_EQ(parse_scale("1000%"), 10);
}

TEST(FilmScale, SaysWhatIsWrong) {
  for (const char* text : {"", "%", "a", "25 %%", "nan", "inf%", "1/4", "25%x", "1e1%"}) {
    const auto scale = parse_scale(text);
    ASSERT_FALSE(scale) << text;
    EXPECT_THAT(scale.error().message, HasSubstr("such as 25% or 0.25")) << text;
  }
  for (const char* text : {"0", "0%", "-1", "-25%", "0.09%", "1001%", "10001"}) {
    const auto scale = parse_scale(text);
    ASSERT_FALSE(scale) << text;
    EXPECT_THAT(scale.error().message, HasSubstr("0.1% to 1000%")) << text;
  }
  EXPECT_THAT(parse_scale("25").error().message, HasSubstr("25% is written 25% or 0.25"));
}

Film film_of(int width, int height) {
  Film film;
  film.width = film.crop_width = width;
  film.height = film.crop_height = height;
  return film;
}

TEST(FilmScale, SidesAreRoundedToTheNearestPixelAndAtLeastOne) {
  for (const auto& [side, scale, expected] : {std::tuple(100, 0.25, 25),
                                              {101, 0.5, 51},
                                              {99, 0.25, 25},
                                              {3, 0.1, 1},
                                              {1, 0.001, 1},
                                              {24, 2.0, 48}}) {
    const Film film = scaled_film(film_of(side, side), scale);
    EXPECT_EQ(film.width, expected) << side << " times " << scale;
    EXPECT_EQ(film.crop_x, 0);
    EXPECT_EQ(film.crop_width, expected) << "the whole film stays the whole film";
    EXPECT_EQ(film.crop_height, expected);
  }
}

TEST(FilmScale, CropWindowsCoverTheSamePart) {
  Film film = film_of(100, 80);
  film.crop_x = 10;
  film.crop_width = 30;
  film.crop_y = 9;
  film.crop_height = 14;
  const Film half = scaled_film(film, 0.5);
  EXPECT_EQ(half.crop_x, 5);
  EXPECT_EQ(half.crop_width, 15);
  EXPECT_EQ(half.crop_y, 4) << "9 / 2 rounded down";
  EXPECT_EQ(half.crop_height, 8) << "to 23 / 2 rounded up";
  // 0.07 times 100 is more than 7 in floating point, and still 7 pixels.
  film = film_of(200, 200);
  film.crop_width = film.crop_x = 100;
  EXPECT_EQ(scaled_film(film, 0.07).crop_x, 7);
  EXPECT_EQ(scaled_film(film, 0.07).crop_width, 7);
  // One pixel in a corner is never lost.
  film.crop_x = 199;
  film.crop_width = 1;
  const Film small = scaled_film(film, 0.001);
  EXPECT_EQ(small.crop_x, 0);
  EXPECT_EQ(small.crop_width, 1);
}

}  // namespace
}  // namespace penumbra
