#include "gl/image_view.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "gl/histogram.h"

namespace penumbra {
namespace {

constexpr PixelRectangle kArea{10, 20, 800, 600};

/// Where on the screen a point of the film is, in film pixels.
std::array<double, 2> on_screen(const ImageView& view, int width, int height, double column, double row) {
  const PixelRectangle place = film_place(view, kArea, width, height);
  return {place.x + column / width * place.width, place.y + row / height * place.height};
}

TEST(ImageView, FitsAtFirstAndIsOneToOneAtZoomOne) {
  EXPECT_EQ(film_place({}, kArea, 400, 200), (PixelRectangle{10, 120, 800, 400}));
  EXPECT_EQ(shown_zoom({}, kArea, 400, 200), 2);
  EXPECT_EQ(film_place({.zoom = 1}, kArea, 400, 200), (PixelRectangle{210, 220, 400, 200}));
  EXPECT_EQ(film_place({.zoom = 1, .x = 0, .y = 1}, kArea, 400, 200), (PixelRectangle{410, 120, 400, 200}));
  EXPECT_EQ(film_place({}, {}, 400, 200), PixelRectangle{});
}

TEST(ImageView, ZoomingKeepsThePointBelowTheMouse) {
  ImageView view;
  const std::array<double, 2> mouse{300, 400};
  for (const double factor : {1.4, 2.0, 3.0, 0.5, 0.9}) {
    const auto before = film_pixel_at(film_place(view, kArea, 400, 200), 400, 200, mouse[0], mouse[1]);
    ASSERT_TRUE(before.has_value());
    view = zoomed(view, kArea, 400, 200, factor, mouse[0], mouse[1]);
    const auto after = on_screen(view, 400, 200, (*before)[0] + 0.5, (*before)[1] + 0.5);
    // Half a film pixel, and the rounding of the place to pixels.
    const double bound = 0.5 * shown_zoom(view, kArea, 400, 200) + 1.5;
    EXPECT_NEAR(after[0], mouse[0], bound);
    EXPECT_NEAR(after[1], mouse[1], bound);
  }
}

TEST(ImageView, ZoomAndPanHaveBounds) {
  ImageView view;
  for (int i = 0; i < 100; ++i) view = zoomed(view, kArea, 400, 200, 2, 410, 320);
  EXPECT_EQ(view.zoom, kMostZoom);
  for (int i = 0; i < 100; ++i) view = zoomed(view, kArea, 400, 200, 0.5, 410, 320);
  EXPECT_EQ(view.zoom, kLeastZoom);
  view = panned({.zoom = 2}, kArea, 400, 200, 1e6, -1e6);
  EXPECT_EQ(view.x, 0);
  EXPECT_EQ(view.y, 1);
  const auto before = on_screen({.zoom = 2}, 400, 200, 100, 100);
  const auto after = on_screen(panned({.zoom = 2}, kArea, 400, 200, 30, -40), 400, 200, 100, 100);
  EXPECT_NEAR(after[0] - before[0], 30, 1);
  EXPECT_NEAR(after[1] - before[1], -40, 1);
  EXPECT_EQ(zoomed({}, kArea, 400, 200, std::nan(""), 0, 0), ImageView{});
}

TEST(ImageView, PixelsAreThoseOfTheFilm) {
  const PixelRectangle place{10, 20, 800, 400};
  using Pixel = std::array<int, 2>;
  EXPECT_EQ(film_pixel_at(place, 400, 200, 10.5, 20.5), (Pixel{0, 0}));
  EXPECT_EQ(film_pixel_at(place, 400, 200, 809.5, 419.5), (Pixel{399, 199}));
  EXPECT_EQ(film_pixel_at(place, 400, 200, 9.5, 30), std::nullopt);
  EXPECT_EQ(film_pixel_at(place, 400, 200, 100, 420), std::nullopt);
  EXPECT_EQ(film_pixel_at({}, 400, 200, 0, 0), std::nullopt);
}

TEST(Histogram, CountsLuminanceByStops) {
  const float inf = INFINITY;
  const std::array<float, 18> rgb{1, 1, 1, 0.5f, 0.5f, 0.5f, 0, 0, 0, inf, 0, 0, -1, 0, 0, 1e9f, 1e9f, 1e9f};
  const Histogram histogram = histogram_of(rgb, 2);
  EXPECT_EQ(histogram.pixels, 6u);
  EXPECT_EQ(histogram.not_positive, 2u);
  EXPECT_EQ(histogram.not_finite, 1u);
  constexpr float kPerStop = Histogram::kBins / (Histogram::kHighestStop - Histogram::kLowestStop);
  const auto bin = [&](float stops) {
    return histogram.counts[std::size_t((stops + 0.01f - Histogram::kLowestStop) * kPerStop)];
  };
  EXPECT_EQ(bin(1), 1);
  EXPECT_EQ(bin(0), 1);
  EXPECT_EQ(histogram.counts.back(), 1);
  EXPECT_EQ(bin(2), 0);
}

}  // namespace
}  // namespace penumbra
