// Letters of dots, for the numbers in pictures that the program makes.
#pragma once

#include <array>
#include <string_view>

#include "scheduler/image/image.h"

namespace penumbra {

/// Rows of a letter, in dots.
constexpr int kDotLetterHeight = 7;
/// From the left of a letter to that of the next, in dots.
constexpr int kDotLetterAdvance = 6;

/// Sets the first three channels in a rectangle of pixels; outside of the image nothing happens.
void fill_pixels(Image& image, int x, int y, int width, int height, const std::array<float, 3>& color);

/// Writes digits, '.', '-', '+' and the small letters that names of error maps have; others leave a gap.
/// (x, y): the upper left corner in pixels; `scale`: pixels a side of each dot.
void write_dots(Image& image, int x, int y, int scale, std::string_view text,
                const std::array<float, 3>& color);

/// The width of the text in pixels.
int dots_width(std::string_view text, int scale);

}  // namespace penumbra
