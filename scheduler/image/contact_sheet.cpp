#include "scheduler/image/contact_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "scheduler/image/image_files.h"
#include "scheduler/image/metrics/dot_text.h"
#include "scheduler/image/picture.h"
#include "scheduler/image/tone_map.h"

namespace penumbra {
namespace {

using Linear = std::array<float, 3>;

constexpr int kMostWidth = 240, kMostHeight = 480;
constexpr int kLeastWidth = 112;                       // for the longest number of a frame
constexpr int kDot = 2;                                // pixels of a dot of the numbers
constexpr double kWiderThanHigh = 1.5;                 // columns for each row
constexpr Linear kBackground{0.014f, 0.014f, 0.014f};  // sRGB signal 32
constexpr Linear kNumber{0.58f, 0.58f, 0.58f};         // 200
constexpr Linear kOutline{0.15f, 0.15f, 0.15f};        // 108

/// The weights with which the pixels along a line cover one of `count` equal parts of it.
struct Covered {
  int first = 0;
  std::vector<float> weights;  ///< sum 1
};

Covered covered_by(int part, int count, int pixels) {
  const double begin = double(part) * pixels / count, end = double(part + 1) * pixels / count;
  Covered covered{.first = int(begin), .weights = {}};
  for (int i = covered.first; i < pixels && i < end; ++i)
    covered.weights.push_back(float((std::min(end, i + 1.0) - std::max(begin, double(i))) / (end - begin)));
  return covered;
}

/// Draws the whole picture into a rectangle of the sheet.
void draw_picture(const Image& picture, const std::array<std::size_t, 3>& beauty, int x, int y, int width,
                  int height, Image& sheet) {
  const auto alpha = picture.channel("A");
  std::vector<Covered> columns;
  for (int i = 0; i < width; ++i) columns.push_back(covered_by(i, width, picture.data.width));
  for (int j = 0; j < height; ++j) {
    const Covered rows = covered_by(j, height, picture.data.height);
    for (int i = 0; i < width; ++i) {
      const Covered& across = columns[std::size_t(i)];
      Linear color{};
      float opacity = 0;
      for (std::size_t row = 0; row < rows.weights.size(); ++row)
        for (std::size_t column = 0; column < across.weights.size(); ++column) {
          const int px = across.first + int(column), py = rows.first + int(row);
          const float weight = rows.weights[row] * across.weights[column];
          for (std::size_t c = 0; c < 3; ++c) color[c] += weight * picture.at(px, py, beauty[c]);
          opacity += weight * (alpha ? picture.at(px, py, *alpha) : 1.0f);
        }
      for (std::size_t c = 0; c < 3; ++c) color[c] += (1 - opacity) * kBackground[c];
      fill_pixels(sheet, x + i, y + j, 1, 1, color);
    }
  }
}

void outline(Image& sheet, int x, int y, int width, int height) {
  fill_pixels(sheet, x, y, width, height, kOutline);
  fill_pixels(sheet, x + 1, y + 1, width - 2, height - 2, kBackground);
}

/// A picture in linear light. Nothing if it is not there or is no picture.
std::optional<Image> picture_in(const std::filesystem::path& file) {
  if (file.empty()) return std::nullopt;
  const Expected<Image> stored = read_image(file);
  if (!stored || !stored->beauty_channels()) return std::nullopt;
  Expected<Image> linear = linear_image(*stored, "");
  return linear ? std::optional(std::move(*linear)) : std::nullopt;
}

}  // namespace

SheetLayout sheet_layout(std::size_t cells, int picture_width, int picture_height) {
  SheetLayout layout;
  layout.columns = std::max(1, int(std::lround(std::sqrt(kWiderThanHigh * double(cells)))));
  layout.columns = std::min(layout.columns, int(cells));
  layout.rows = (int(cells) + layout.columns - 1) / layout.columns;
  layout.cell_width = std::clamp(picture_width, kLeastWidth, kMostWidth);
  const double height = double(layout.cell_width) * picture_height / picture_width;
  layout.cell_height = int(std::lround(std::clamp(height, 1.0, double(kMostHeight))));
  return layout;
}

std::vector<std::size_t> evenly_chosen(std::size_t count, std::size_t most) {
  const std::size_t chosen = std::min(count, most);
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < chosen; ++i)
    indices.push_back(chosen < 2 ? 0 : (2 * i * (count - 1) + chosen - 1) / (2 * (chosen - 1)));
  return indices;
}

Expected<Image> contact_sheet(std::span<const SheetFrame> frames) {
  const std::vector<std::size_t> chosen = evenly_chosen(frames.size(), kMostSheetFrames);
  // One picture at a time is in memory.
  std::size_t first = 0;
  std::optional<Image> picture;
  for (; first < chosen.size(); ++first)
    if ((picture = picture_in(frames[chosen[first]].picture))) break;
  if (!picture) return fail("there is no picture of a frame");
  const SheetLayout layout = sheet_layout(chosen.size(), picture->data.width, picture->data.height);
  Image sheet;
  sheet.data = sheet.display = {0, 0, layout.width(), layout.height()};
  sheet.channels = {"R", "G", "B"};
  sheet.values.resize(3 * sheet.pixels());
  fill_pixels(sheet, 0, 0, layout.width(), layout.height(), kBackground);
  for (std::size_t cell = 0; cell < chosen.size(); ++cell) {
    const int x = layout.x(cell), y = layout.y(cell);
    if (cell > first) {
      picture.reset();
      picture = picture_in(frames[chosen[cell]].picture);
    }
    if (cell >= first && picture) {
      // Whole, in the middle: a picture may have another shape than the first.
      const double scale = std::min(double(layout.cell_width) / picture->data.width,
                                    double(layout.cell_height) / picture->data.height);
      const int width = std::clamp(int(std::lround(scale * picture->data.width)), 1, layout.cell_width);
      const int height = std::clamp(int(std::lround(scale * picture->data.height)), 1, layout.cell_height);
      draw_picture(*picture, *picture->beauty_channels(), x + (layout.cell_width - width) / 2,
                   y + (layout.cell_height - height) / 2, width, height, sheet);
    } else {
      outline(sheet, x, y, layout.cell_width, layout.cell_height);
    }
    const std::string number = fmt::to_string(frames[chosen[cell]].frame);
    write_dots(sheet, x + (layout.cell_width - dots_width(number, kDot)) / 2,
               y + layout.cell_height + (SheetLayout::kLabel - kDotLetterHeight * kDot) / 2, kDot, number,
               kNumber);
  }
  return sheet;
}

Expected<std::vector<std::uint8_t>> contact_sheet_png(std::span<const SheetFrame> frames) {
  const Expected<Image> sheet = contact_sheet(frames);
  if (!sheet) return std::unexpected(sheet.error());
  return encode_png(*sheet);
}

}  // namespace penumbra
