#include "gl/image_view.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

bool is_empty(const PixelRectangle& area, int film_width, int film_height) {
  return area.width < 1 || area.height < 1 || film_width < 1 || film_height < 1;
}

int rounded(double x) { return int(std::lround(x)); }

}  // namespace

PixelRectangle letterboxed(const PixelRectangle& area, int film_width, int film_height) {
  if (is_empty(area, film_width, film_height)) return {};
  const double scale = std::min(double(area.width) / film_width, double(area.height) / film_height);
  const int width = std::clamp(rounded(scale * film_width), 1, area.width);
  const int height = std::clamp(rounded(scale * film_height), 1, area.height);
  return {area.x + (area.width - width) / 2, area.y + (area.height - height) / 2, width, height};
}

double shown_zoom(const ImageView& view, const PixelRectangle& area, int film_width, int film_height) {
  if (view.zoom > 0) return view.zoom;
  if (is_empty(area, film_width, film_height)) return 1;
  return std::min(double(area.width) / film_width, double(area.height) / film_height);
}

PixelRectangle film_place(const ImageView& view, const PixelRectangle& area, int film_width,
                          int film_height) {
  if (view.zoom <= 0 || is_empty(area, film_width, film_height))
    return letterboxed(area, film_width, film_height);
  const int width = std::max(1, rounded(view.zoom * film_width));
  const int height = std::max(1, rounded(view.zoom * film_height));
  return {area.x + rounded(0.5 * area.width - view.x * width),
          area.y + rounded(0.5 * area.height - view.y * height), width, height};
}

ImageView panned(const ImageView& view, const PixelRectangle& area, int film_width, int film_height,
                 double dx, double dy) {
  if (is_empty(area, film_width, film_height)) return view;
  ImageView moved = view;
  moved.zoom = shown_zoom(view, area, film_width, film_height);
  moved.x = std::clamp(view.x - dx / (moved.zoom * film_width), 0.0, 1.0);
  moved.y = std::clamp(view.y - dy / (moved.zoom * film_height), 0.0, 1.0);
  return moved;
}

ImageView zoomed(const ImageView& view, const PixelRectangle& area, int film_width, int film_height,
                 double factor, double x, double y) {
  if (is_empty(area, film_width, film_height) || !(factor > 0)) return view;
  const double fitting = shown_zoom({}, area, film_width, film_height);
  const double before = shown_zoom(view, area, film_width, film_height);
  ImageView result = view;
  result.zoom = std::clamp(before * factor, std::min(kLeastZoom, fitting), std::max(kMostZoom, fitting));
  // The film's point at (x, y) is at the distance (x - middle) / zoom from the one in the middle.
  const double change = 1 / before - 1 / result.zoom;
  const double right = x - (area.x + 0.5 * area.width), down = y - (area.y + 0.5 * area.height);
  result.x = std::clamp(view.x + right * change / film_width, 0.0, 1.0);
  result.y = std::clamp(view.y + down * change / film_height, 0.0, 1.0);
  return result;
}

std::optional<std::array<int, 2>> film_pixel_at(const PixelRectangle& place, int film_width, int film_height,
                                                double x, double y) {
  if (place.width < 1 || place.height < 1) return std::nullopt;
  const double column = (x - place.x) / place.width * film_width;
  const double row = (y - place.y) / place.height * film_height;
  if (!(column >= 0 && row >= 0 && column < film_width && row < film_height)) return std::nullopt;
  return std::array{int(column), int(row)};
}

}  // namespace penumbra
