#include "scheduler/image/metrics/color_bar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scheduler/image/metrics/color_map.h"

namespace penumbra {
namespace {

constexpr int kGlyphWidth = 5, kGlyphHeight = 7, kAdvance = 6;

/// A letter of 5 × 7 dots; bit 4 is the left one of a row. The numbers and the names of maps need no others.
struct Glyph {
  char letter;
  unsigned char rows[kGlyphHeight];
};
constexpr Glyph kGlyphs[] = {
    {'0', {0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e}}, {'1', {0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e}},
    {'2', {0x0e, 0x11, 0x01, 0x02, 0x04, 0x08, 0x1f}}, {'3', {0x1f, 0x02, 0x04, 0x02, 0x01, 0x11, 0x0e}},
    {'4', {0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02}}, {'5', {0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e}},
    {'6', {0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e}}, {'7', {0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08}},
    {'8', {0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e}}, {'9', {0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c}},
    {'.', {0x00, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x0c}}, {'-', {0x00, 0x00, 0x00, 0x1f, 0x00, 0x00, 0x00}},
    {'+', {0x00, 0x04, 0x04, 0x1f, 0x04, 0x04, 0x00}}, {'a', {0x00, 0x00, 0x0e, 0x01, 0x0f, 0x11, 0x0f}},
    {'b', {0x10, 0x10, 0x16, 0x19, 0x11, 0x11, 0x1e}}, {'e', {0x00, 0x00, 0x0e, 0x11, 0x1f, 0x10, 0x0e}},
    {'f', {0x06, 0x09, 0x08, 0x1c, 0x08, 0x08, 0x08}}, {'i', {0x04, 0x00, 0x0c, 0x04, 0x04, 0x04, 0x0e}},
    {'l', {0x0c, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0e}}, {'m', {0x00, 0x00, 0x1a, 0x15, 0x15, 0x11, 0x11}},
    {'p', {0x00, 0x00, 0x1e, 0x11, 0x1e, 0x10, 0x10}}, {'r', {0x00, 0x00, 0x16, 0x19, 0x10, 0x10, 0x10}},
    {'s', {0x00, 0x00, 0x0e, 0x10, 0x0e, 0x01, 0x1e}}, {'z', {0x00, 0x00, 0x1f, 0x02, 0x04, 0x08, 0x1f}}};

/// A rectangle of pixels that can be filled; outside of the image nothing happens.
class Canvas {
 public:
  explicit Canvas(Image& image) : image_(image) {}
  void fill(int x, int y, int width, int height, const std::array<float, 3>& color) {
    for (int row = std::max(0, y); row < std::min(y + height, image_.data.height); ++row)
      for (int column = std::max(0, x); column < std::min(x + width, image_.data.width); ++column)
        for (std::size_t c = 0; c < 3; ++c)
          image_.values[(std::size_t(row) * std::size_t(image_.data.width) + std::size_t(column)) *
                            image_.channels.size() +
                        c] = color[c];
  }
  void write(int x, int y, int scale, const std::string& text) {
    for (const char letter : text) {
      const auto glyph = std::ranges::find(kGlyphs, letter, &Glyph::letter);
      for (int row = 0; row < kGlyphHeight && glyph != std::end(kGlyphs); ++row)
        for (int column = 0; column < kGlyphWidth; ++column)
          if ((glyph->rows[row] >> (kGlyphWidth - 1 - column) & 1) != 0)
            fill(x + column * scale, y + row * scale, scale, scale, {0, 0, 0});
      x += kAdvance * scale;
    }
  }

 private:
  Image& image_;
};

int text_width(const std::string& text, int scale) { return (int(text.size()) * kAdvance - 1) * scale; }

std::string number_label(double value) { return fmt::format("{:.4g}", value); }

std::vector<double> powers_of_ten(const MapRange& range, int most) {
  const int first = int(std::ceil(std::log10(range.low) - 1e-9));
  const int last = int(std::floor(std::log10(range.high) + 1e-9));
  const int stride = 1 + (last - first) / most;
  std::vector<double> values;
  for (int e = first; e <= last; e += stride) values.push_back(std::pow(10.0, e));
  return values;
}

std::vector<double> round_multiples(const MapRange& range, int most) {
  const double least = (range.high - range.low) / most;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  const double step = power * (least <= power ? 1 : least <= 2 * power ? 2 : least <= 5 * power ? 5 : 10);
  std::vector<double> values;
  constexpr double kRounding = 1e-9;
  for (double k = std::ceil(range.low / step - kRounding); k * step <= range.high + kRounding * step; ++k)
    values.push_back(k * step + 0.0);  // no -0
  return values;
}

}  // namespace

std::vector<BarTick> bar_ticks(const MapRange& range, int most) {
  std::vector<double> values = range.logarithmic && range.high >= 10 * range.low
                                   ? powers_of_ten(range, most)
                                   : round_multiples(range, most);
  if (values.size() < 2) values = {range.low, range.high};
  std::vector<BarTick> ticks;
  for (const double value : values)
    ticks.push_back({std::clamp(range.position(value), 0.0, 1.0), number_label(value)});
  return ticks;
}

Image with_color_bar(const Image& heat_map, const MapRange& range, const std::string& name) {
  constexpr int kSmallestWidth = 240, kPixelsPerScale = 600;
  const int width = std::max(heat_map.data.width, kSmallestWidth);
  const int scale = std::max(2, width / kPixelsPerScale);  // pixels of a dot of the letters
  const int gap = 4 * scale, bar_height = 10 * scale, tick = 3 * scale, text = kGlyphHeight * scale;
  const int bar_y = heat_map.data.height + gap, label_y = bar_y + bar_height + tick + scale;
  const int name_y = label_y + text + gap;
  constexpr int kLongestLabel = 9;  // "-1.234e-5"
  const int inset = 2 * kAdvance * scale, length = width - 2 * inset;

  Image image = heat_map;
  image.data.width = width;
  image.data.height = name_y + text + gap;
  image.display = image.data;
  const std::size_t channels = image.channels.size();
  image.values.assign(image.pixels() * channels, std::numeric_limits<float>::quiet_NaN());
  Canvas canvas(image);
  canvas.fill(0, 0, image.data.width, image.data.height, {1, 1, 1});
  for (int y = 0; y < heat_map.data.height; ++y) {
    const auto row = heat_map.values.begin() +
                     std::ptrdiff_t(std::size_t(y) * std::size_t(heat_map.data.width) * channels);
    std::copy_n(row, std::size_t(heat_map.data.width) * channels,
                image.values.begin() + std::ptrdiff_t(std::size_t(y) * std::size_t(width) * channels));
  }
  canvas.fill(inset - 1, bar_y - 1, length + 2, bar_height + 2, {0, 0, 0});
  for (int x = 0; x < length; ++x)
    canvas.fill(inset + x, bar_y, 1, bar_height, heat_color((x + 0.5) / length));
  for (const BarTick& mark : bar_ticks(range, std::max(2, length / (kLongestLabel * kAdvance * scale)))) {
    const int x = inset + int(std::lround(mark.position * (length - 1)));
    canvas.fill(x - scale / 2, bar_y + bar_height, scale, tick, {0, 0, 0});
    const int wide = text_width(mark.label, scale);
    canvas.write(std::clamp(x - wide / 2, scale, std::max(scale, width - wide - scale)), label_y, scale,
                 mark.label);
  }
  canvas.write(inset + (length - text_width(name, scale)) / 2, name_y, scale, name);
  return image;
}

}  // namespace penumbra
