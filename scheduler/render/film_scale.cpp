#include "scheduler/render/film_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "scenes/number.h"

namespace penumbra {
namespace {

constexpr double kLeastScale = 0.001, kLargestScale = 10;
// Products of whole numbers and a scale are whole up to rounding: 0.07 * 100 is 7.000000000000001.
constexpr double kRounding = 1e-9;

int scaled_side(int side, double scale) { return int(std::max(1L, std::lround(side * scale))); }

/// Part [from, to) of a film's side, in a side that is scaled to `size`; not empty.
std::pair<int, int> scaled_part(int from, int to, double scale, int size) {
  const int first = std::min(int(std::floor(from * scale + kRounding)), size - 1);
  return {first, std::clamp(int(std::ceil(to * scale - kRounding)), first + 1, size)};
}

}  // namespace

Expected<double> parse_scale(std::string_view text) {
  const bool is_percent = text.ends_with('%');
  // The decimal exponent keeps 33.3% and 0.333 the same number, which a division would not.
  const auto number =
      parse_number(is_percent ? fmt::format("{}e-2", text.substr(0, text.size() - 1)) : std::string(text));
  if (!number) return fail(fmt::format("'{}' is not a scale such as 25% or 0.25", text));
  const double scale = *number;
  if (scale >= kLeastScale && scale <= kLargestScale) return scale;
  const bool forgot_percent = !is_percent && scale > kLargestScale && scale / 100 <= kLargestScale;
  return fail(
      fmt::format("'{}' is not in the range from 0.1% to 1000%{}", text,
                  forgot_percent ? fmt::format("; {0}% is written {0}% or {1}", scale, scale / 100) : ""));
}

CropRectangle scaled_crop(const CropRectangle& crop, double scale, const Film& film) {
  const auto [x0, x1] = scaled_part(crop.x0, crop.x1, scale, film.width);
  const auto [y0, y1] = scaled_part(crop.y0, crop.y1, scale, film.height);
  return {x0, y0, x1, y1};
}

Film scaled_film(Film film, double scale) {
  film.width = scaled_side(film.width, scale);
  film.height = scaled_side(film.height, scale);
  const CropRectangle crop = scaled_crop(
      {film.crop_x, film.crop_y, film.crop_x + film.crop_width, film.crop_y + film.crop_height}, scale, film);
  film.crop_x = crop.x0;
  film.crop_y = crop.y0;
  film.crop_width = crop.x1 - crop.x0;
  film.crop_height = crop.y1 - crop.y0;
  return film;
}

}  // namespace penumbra
