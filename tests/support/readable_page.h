// What every page must be: readable on a phone and on a wide screen, in light and in dark.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/browser.h"

namespace penumbra {

/// Fails where something is wider than the viewport, a text is cut off or has a contrast below 4.5 (WCAG 2.1,
/// level AA), or a text in an SVG is smaller than 12 pixels. `svg_texts`: at least so many must be there.
inline void expect_readable(const nlohmann::json& seen, int width, int svg_texts) {
  constexpr double kContrast = 4.5, kFont = 12, kRounding = 1e-3;
  EXPECT_EQ(seen["viewport"], width);
  EXPECT_EQ(seen["scroll_width"], width) << "something is wider than the page";
  EXPECT_GT(seen["texts"].get<int>(), 20);
  EXPECT_GE(seen["svg_texts"].get<int>(), svg_texts);
  EXPECT_GE(seen["contrast"]["ratio"].get<double>(), kContrast) << seen["contrast"]["text"];
  EXPECT_GE(seen["svg_font"]["size"].get<double>(), kFont - kRounding) << seen["svg_font"]["text"];
  EXPECT_EQ(seen["cut_off"], nlohmann::json::array());
}

/// The same of a page at the widths of a phone and of a laptop, in light and in dark.
inline void expect_readable(const std::string& html, int svg_texts) {
  for (const int width : {390, 1280})
    for (const bool dark : {false, true}) {
      SCOPED_TRACE(std::to_string(width) + (dark ? " pixels, dark" : " pixels, light"));
      const auto seen = view_page(html, {.width = width, .dark = dark});
      ASSERT_TRUE(seen) << seen.error().message;
      expect_readable(*seen, width, svg_texts);
    }
}

}  // namespace penumbra
