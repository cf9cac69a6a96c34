// Contact sheets against what their layout and the letters' dots say of single pixels.
#include "scheduler/image/contact_sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "kernels/host/atomic_file.h"
#include "scheduler/image/image_files.h"
#include "scheduler/image/metrics/dot_text.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using testing::ElementsAre;

/// Writes a PNG whose pixels are told by their place; three or four bytes each.
template <typename Color>
std::filesystem::path png(const TemporaryFolder& folder, const std::string& name, int width, int height,
                          bool has_alpha, Color color) {
  std::vector<std::uint8_t> bytes;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const int byte : color(x, y)) bytes.push_back(std::uint8_t(byte));
  const auto encoded = encode_png_bytes(width, height, bytes, has_alpha);
  EXPECT_TRUE(write_output(folder.path() / name, *encoded).has_value());
  return folder.path() / name;
}

std::vector<int> grey_pixel(int value) { return {value, value, value}; }

TEST(ContactSheet, ChoosesEvenlyWithTheFirstAndTheLast) {
  EXPECT_THAT(evenly_chosen(3, 24), ElementsAre(0, 1, 2));
  EXPECT_THAT(evenly_chosen(11, 6), ElementsAre(0, 2, 4, 6, 8, 10));
  EXPECT_THAT(evenly_chosen(1, 24), ElementsAre(0));
  const auto many = evenly_chosen(1000, kMostSheetFrames);
  ASSERT_EQ(many.size(), kMostSheetFrames);
  EXPECT_EQ(many.front(), 0u);
  EXPECT_EQ(many.back(), 999u);
  for (std::size_t i = 1; i < many.size(); ++i)
    EXPECT_NEAR(double(many[i] - many[i - 1]), 999.0 / 23, 1) << i;
}

TEST(ContactSheet, CellsLieInAGridWithoutOverlap) {
  const SheetLayout layout = sheet_layout(24, 1920, 1080);
  EXPECT_EQ(layout.columns, 6);
  EXPECT_EQ(layout.rows, 4);
  EXPECT_EQ(layout.cell_width, 240);
  EXPECT_EQ(layout.cell_height, 135);
  EXPECT_EQ(layout.width(), 8 + 6 * 248);
  EXPECT_EQ(layout.height(), 8 + 4 * (135 + 20 + 8));
  EXPECT_EQ(layout.x(7), 8 + 248);
  EXPECT_EQ(layout.y(7), 8 + 163);
  for (std::size_t cells = 1; cells <= 24; ++cells) {
    const SheetLayout some = sheet_layout(cells, 400, 300);
    EXPECT_GE(some.columns * some.rows, int(cells));
    EXPECT_LT(some.columns * (some.rows - 1), int(cells)) << "no row is empty";
  }
  EXPECT_EQ(sheet_layout(2, 160, 90).cell_width, 160) << "pictures are not made larger";
  EXPECT_LE(sheet_layout(2, 10, 4000).cell_height, 480);
}

TEST(ContactSheet, AveragesInLinearLight) {
  const TemporaryFolder folder;
  // Columns of black and white, two to a pixel of the sheet: half the light, not half the signal.
  const auto stripes =
      png(folder, "a.png", 480, 270, false, [](int x, int) { return grey_pixel(x % 2 == 0 ? 0 : 255); });
  // Five columns to two: 1 1 ½ | ½ 0 0 of the light by parts of columns.
  const auto fifths =
      png(folder, "b.png", 600, 270, false, [](int x, int) { return grey_pixel(x % 5 < 2 ? 255 : 0); });
  const auto sheet = contact_sheet(std::vector<SheetFrame>{{1, stripes}, {2, fifths}});
  ASSERT_TRUE(sheet.has_value()) << sheet.error().message;
  const SheetLayout layout = sheet_layout(2, 480, 270);
  EXPECT_NEAR(sheet->at(layout.x(0) + 100, layout.y(0) + 60, 1), 0.5, 1e-5);
  const int top = layout.y(1) + (135 - 108) / 2;  // its own shape: 240 × 108 in the middle of the cell
  EXPECT_NEAR(sheet->at(layout.x(1) + 20, top + 50, 1), 2 / 2.5, 1e-5);
  EXPECT_NEAR(sheet->at(layout.x(1) + 21, top + 50, 1), 0, 1e-5);
  const float background = sheet->at(0, 0, 1);
  EXPECT_EQ(sheet->at(layout.x(1) + 20, layout.y(1) + 5, 1), background) << "beside the narrower picture";
}

TEST(ContactSheet, PicturesWithAlphaLieOverTheBackground) {
  const TemporaryFolder folder;
  const auto half = png(folder, "a.png", 240, 120, true, [](int x, int) {
    return std::vector<int>{255, 255, 255, x < 120 ? 0 : 255};
  });
  const auto sheet = contact_sheet(std::vector<SheetFrame>{{1, half}, {2, half}});
  ASSERT_TRUE(sheet.has_value()) << sheet.error().message;
  EXPECT_NEAR(sheet->at(8 + 50, 8 + 50, 0), sheet->at(0, 0, 0), 1e-6);
  EXPECT_NEAR(sheet->at(8 + 200, 8 + 50, 0), 1, 1e-6);
}

TEST(ContactSheet, WritesTheNumberBelowThePicture) {
  const TemporaryFolder folder;
  const auto black = png(folder, "a.png", 240, 120, false, [](int, int) { return grey_pixel(0); });
  const auto sheet = contact_sheet(std::vector<SheetFrame>{{7, black}, {17, black}});
  ASSERT_TRUE(sheet.has_value()) << sheet.error().message;
  const float background = sheet->at(0, 0, 0);
  const auto is_ink = [&](int x, int y) { return sheet->at(x, y, 0) > background; };
  // The 7 is five dots wide, two pixels each, in the middle below the picture; its first row is full, and of
  // the second the right dot alone.
  const int left = 8 + (240 - 10) / 2, top = 8 + 120 + 3;
  for (int x = left; x < left + 10; ++x) EXPECT_TRUE(is_ink(x, top)) << x;
  EXPECT_FALSE(is_ink(left - 1, top));
  EXPECT_FALSE(is_ink(left + 10, top));
  EXPECT_FALSE(is_ink(left, top - 1));
  for (int x = left; x < left + 8; ++x) EXPECT_FALSE(is_ink(x, top + 2)) << x;
  EXPECT_TRUE(is_ink(left + 8, top + 2));
  // Of 17 the 7 is one letter to the right of the 1, whose first row has its middle dot alone.
  const int second = 8 + 248 + (240 - 22) / 2;
  for (int x = second + 12; x < second + 22; ++x) EXPECT_TRUE(is_ink(x, top)) << x;
  EXPECT_TRUE(is_ink(second + 4, top));
  EXPECT_FALSE(is_ink(second, top));
}

TEST(ContactSheet, MissingFramesAreOutlined) {
  const TemporaryFolder folder;
  const auto white = png(folder, "a.png", 240, 120, false, [](int, int) { return grey_pixel(255); });
  write_text(folder.path() / "broken.png", "no picture");
  const auto sheet =
      contact_sheet(std::vector<SheetFrame>{{1, white}, {2, {}}, {3, folder.path() / "broken.png"}});
  ASSERT_TRUE(sheet.has_value()) << sheet.error().message;
  const SheetLayout layout = sheet_layout(3, 240, 120);
  EXPECT_EQ(sheet->at(layout.x(0) + 5, layout.y(0) + 5, 0), 1);
  const float background = sheet->at(0, 0, 0);
  for (const std::size_t cell : {1u, 2u}) {
    const int x = layout.x(cell), y = layout.y(cell);
    for (const auto& [dx, dy] : {std::pair{0, 0}, {239, 0}, {0, 119}, {239, 119}, {100, 0}, {0, 60}})
      EXPECT_GT(sheet->at(x + dx, y + dy, 0), 5 * background) << dx << "," << dy;
    EXPECT_EQ(sheet->at(x + 1, y + 1, 0), background);
    EXPECT_EQ(sheet->at(x + 120, y + 60, 0), background);
  }
}

TEST(ContactSheet, NeedsAPicture) {
  EXPECT_FALSE(contact_sheet(std::vector<SheetFrame>{{1, {}}, {2, "nowhere.png"}}).has_value());
}

TEST(ContactSheet, IsAPngOfThatSize) {
  const TemporaryFolder folder;
  const auto white = png(folder, "a.png", 300, 200, false, [](int, int) { return grey_pixel(255); });
  const std::vector<SheetFrame> frames(5, {1, white});
  const auto bytes = contact_sheet_png(frames);
  ASSERT_TRUE(bytes.has_value()) << bytes.error().message;
  ASSERT_TRUE(write_output(folder.path() / "sheet.png", *bytes).has_value());
  const auto image = read_image(folder.path() / "sheet.png");
  ASSERT_TRUE(image.has_value());
  const SheetLayout layout = sheet_layout(5, 300, 200);
  EXPECT_EQ(image->data.width, layout.width());
  EXPECT_EQ(image->data.height, layout.height());
}

}  // namespace
}  // namespace penumbra
