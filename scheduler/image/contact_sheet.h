// One picture with small pictures of a shot's frames and their numbers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"

namespace penumbra {

struct SheetFrame {
  int frame = 0;
  std::filesystem::path picture = {};  ///< a file of a display, such as PNG; empty: there is none
};

/// Sizes in pixels.
struct SheetLayout {
  static constexpr int kMargin = 8;  ///< around the sheet and between cells
  static constexpr int kLabel = 20;  ///< below each picture, for its number
  int columns = 0, rows = 0;
  int cell_width = 0, cell_height = 0;  ///< of a picture

  [[nodiscard]] int width() const { return kMargin + columns * (cell_width + kMargin); }
  [[nodiscard]] int height() const { return kMargin + rows * (cell_height + kLabel + kMargin); }
  /// The upper left corner of the picture of a cell.
  [[nodiscard]] int x(std::size_t cell) const {
    return kMargin + int(cell) % columns * (cell_width + kMargin);
  }
  [[nodiscard]] int y(std::size_t cell) const {
    return kMargin + int(cell) / columns * (cell_height + kLabel + kMargin);
  }
};

/// The most pictures of a sheet.
constexpr std::size_t kMostSheetFrames = 24;

/// The cells of that many pictures, each as large as a picture of that size, but at most 240 wide.
SheetLayout sheet_layout(std::size_t cells, int picture_width, int picture_height);

/// At most `most` of `count` things, evenly, with the first and the last: their indices, ascending.
std::vector<std::size_t> evenly_chosen(std::size_t count, std::size_t most);

/// The sheet of at most kMostSheetFrames frames, chosen evenly, in the given order; linear R, G and B.
/// Pictures are made smaller by a box filter in linear light, over the sheet's background where they have
/// alpha. A frame without a picture, or with one that cannot be read, has an outlined cell. Error: there is
/// no picture at all.
Expected<Image> contact_sheet(std::span<const SheetFrame> frames);

/// The sheet as the bytes of a PNG file.
Expected<std::vector<std::uint8_t>> contact_sheet_png(std::span<const SheetFrame> frames);

}  // namespace penumbra
