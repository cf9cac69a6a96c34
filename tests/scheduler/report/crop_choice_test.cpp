#include "scheduler/report/crop_choice.h"

#include <gtest/gtest.h>

#include <cmath>

namespace penumbra {
namespace {

using Kind = CropChoice::Kind;

constexpr PixelWindow kWindow{10, 20, 40, 30};

std::vector<double> errors_at(int x0, int y0, int size) {
  std::vector<double> errors(std::size_t(kWindow.width * kWindow.height), 1e-3);
  for (int y = y0; y < y0 + size; ++y)
    for (int x = x0; x < x0 + size; ++x)
      errors[std::size_t((y - kWindow.y) * kWindow.width + x - kWindow.x)] = 1;
  return errors;
}

TEST(CropChoice, IsParsed) {
  EXPECT_EQ(parse_crop_choice("error")->kind, Kind::kLargestError);
  EXPECT_EQ(parse_crop_choice("centre:24")->kind, Kind::kCentre);
  EXPECT_EQ(parse_crop_choice("centre:24")->size, 24);
  const auto place = parse_crop_choice("5,6,7");
  ASSERT_TRUE(place);
  EXPECT_EQ(place->kind, Kind::kPlace);
  EXPECT_EQ(place->x, 5);
  EXPECT_EQ(place->y, 6);
  EXPECT_EQ(place->size, 7);
  for (const char* bad :
       {"", "middle", "error:", "error:0", "error:-1", "1,2", "1,2,0", "-1,2,3", "1,2,3,4", "1,2,3x"})
    EXPECT_FALSE(parse_crop_choice(bad)) << bad;
}

TEST(CropChoice, FindsWhereTheErrorIsLargest) {
  const auto chosen = choose_crop({Kind::kLargestError, 0, 0, 8}, kWindow, errors_at(30, 35, 8));
  EXPECT_EQ(chosen.window, (PixelWindow{30, 35, 8, 8}));
}

TEST(CropChoice, OneFireflyIsNotAllThereIsToSee) {
  auto errors = errors_at(30, 35, 8);
  errors[0] = 1e9;
  errors[1] = NAN;
  EXPECT_EQ(choose_crop({Kind::kLargestError, 0, 0, 8}, kWindow, errors).window, (PixelWindow{30, 35, 8, 8}));
}

TEST(CropChoice, StaysInTheImage) {
  const auto errors = errors_at(10, 20, 1);
  EXPECT_EQ(choose_crop({Kind::kPlace, 45, 100, 10}, kWindow, errors).window, (PixelWindow{40, 40, 10, 10}));
  EXPECT_EQ(choose_crop({Kind::kPlace, 0, 0, 500}, kWindow, errors).window, kWindow);
  EXPECT_EQ(choose_crop({Kind::kCentre, 0, 0, 10}, kWindow, errors).window, (PixelWindow{25, 30, 10, 10}));
  EXPECT_EQ(choose_crop({}, {0, 0, 1, 1}, {0.0}).window, (PixelWindow{0, 0, 1, 1}));
}

}  // namespace
}  // namespace penumbra
