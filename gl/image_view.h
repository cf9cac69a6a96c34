// Which part of the film is shown, and how large.
#pragma once

#include <array>
#include <optional>

namespace penumbra {

/// Pixels from the upper left corner of a window's framebuffer; y grows downwards.
struct PixelRectangle {
  int x = 0, y = 0, width = 0, height = 0;
  bool operator==(const PixelRectangle&) const = default;
};

constexpr double kLeastZoom = 1.0 / 32, kMostZoom = 64;

struct ImageView {
  double zoom = 0;          ///< screen pixels per film pixel; 0: as large as fits
  double x = 0.5, y = 0.5;  ///< the point of the film at the middle of the area, as fractions of its size
  bool operator==(const ImageView&) const = default;
};

/// The largest rectangle with the film's aspect ratio in the middle of `area`, at least one pixel in each
/// direction. Empty if the area or the film is empty.
PixelRectangle letterboxed(const PixelRectangle& area, int film_width, int film_height);

/// Where the whole film is on the screen. It may extend beyond the area on all sides. Empty if the area or
/// the film is empty.
PixelRectangle film_place(const ImageView& view, const PixelRectangle& area, int film_width, int film_height);

/// Screen pixels per film pixel.
double shown_zoom(const ImageView& view, const PixelRectangle& area, int film_width, int film_height);

/// Zoomed by `factor` with the film's point at screen pixel (x, y) fixed. The zoom stays within 1/32 … 64,
/// and does not become smaller than the one that fits if that is below 1/32.
ImageView zoomed(const ImageView& view, const PixelRectangle& area, int film_width, int film_height,
                 double factor, double x, double y);

/// The film moved by screen pixels, its centre at most as far as the area's middle can be kept on it.
ImageView panned(const ImageView& view, const PixelRectangle& area, int film_width, int film_height,
                 double dx, double dy);

/// The film pixel at a position on the screen; nothing beside the film.
std::optional<std::array<int, 2>> film_pixel_at(const PixelRectangle& place, int film_width, int film_height,
                                                double x, double y);

}  // namespace penumbra
