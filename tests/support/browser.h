// Shows a page in headless Chromium and measures what a reader sees.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "kernels/host/error.h"

namespace penumbra {

/// Chromium or a relative of it in PATH.
std::optional<std::filesystem::path> find_browser();

constexpr const char* kNoBrowser = "no Chromium here (Debian: apt-get install chromium)";

/// A function in JavaScript that opens a page's <details> and returns what view_page does, without `script`.
extern const char* const kMeasurePage;

struct PageView {
  int width = 1280;  ///< of the viewport, in CSS pixels
  bool dark = false;
  std::string script = "null";  ///< JavaScript, whose value is "script" of the result
};

/// Shows the page, opens its <details>, and returns
///   viewport, scroll_width      widths in pixels
///   texts, svg_texts            how many were measured
///   contrast                    the lowest WCAG contrast of a text with its background: ratio, text
///   svg_font                    the smallest size of a text in an SVG as shown, in pixels: size, text
///   cut_off                     texts that are partly outside of their SVG, or of the viewport and of no box
///                               that scrolls
///   script
/// Errors: the browser does not run, or gives no answer.
Expected<nlohmann::json> view_page(const std::string& html, const PageView& view);

}  // namespace penumbra
