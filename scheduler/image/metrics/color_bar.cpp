#include "scheduler/image/metrics/color_bar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scheduler/image/metrics/color_map.h"
#include "scheduler/image/metrics/dot_text.h"

namespace penumbra {
namespace {

constexpr std::array<float, 3> kBlack{0, 0, 0};

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
  const int gap = 4 * scale, bar_height = 10 * scale, tick = 3 * scale, text = kDotLetterHeight * scale;
  const int bar_y = heat_map.data.height + gap, label_y = bar_y + bar_height + tick + scale;
  const int name_y = label_y + text + gap;
  constexpr int kLongestLabel = 9;  // "-1.234e-5"
  const int inset = 2 * kDotLetterAdvance * scale, length = width - 2 * inset;

  Image image = heat_map;
  image.data.width = width;
  image.data.height = name_y + text + gap;
  image.display = image.data;
  const std::size_t channels = image.channels.size();
  image.values.assign(image.pixels() * channels, std::numeric_limits<float>::quiet_NaN());
  fill_pixels(image, 0, 0, image.data.width, image.data.height, {1, 1, 1});
  for (int y = 0; y < heat_map.data.height; ++y) {
    const auto row = heat_map.values.begin() +
                     std::ptrdiff_t(std::size_t(y) * std::size_t(heat_map.data.width) * channels);
    std::copy_n(row, std::size_t(heat_map.data.width) * channels,
                image.values.begin() + std::ptrdiff_t(std::size_t(y) * std::size_t(width) * channels));
  }
  fill_pixels(image, inset - 1, bar_y - 1, length + 2, bar_height + 2, kBlack);
  for (int x = 0; x < length; ++x)
    fill_pixels(image, inset + x, bar_y, 1, bar_height, heat_color((x + 0.5) / length));
  for (const BarTick& mark :
       bar_ticks(range, std::max(2, length / (kLongestLabel * kDotLetterAdvance * scale)))) {
    const int x = inset + int(std::lround(mark.position * (length - 1)));
    fill_pixels(image, x - scale / 2, bar_y + bar_height, scale, tick, kBlack);
    const int wide = dots_width(mark.label, scale);
    write_dots(image, std::clamp(x - wide / 2, scale, std::max(scale, width - wide - scale)), label_y, scale,
               mark.label, kBlack);
  }
  write_dots(image, inset + (length - dots_width(name, scale)) / 2, name_y, scale, name, kBlack);
  return image;
}

}  // namespace penumbra
