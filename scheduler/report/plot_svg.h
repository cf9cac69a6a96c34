// What a page needs of gnuplot's SVG: text for screen readers, colours that follow the page.
#pragma once

#include <string>
#include <string_view>

namespace penumbra {

// The colours of plots beside those of curves, as they are in files.
constexpr const char* kPlotText = "#333333";
constexpr const char* kPlotFrame = "#777777";
constexpr const char* kPlotGuide = "#888888";
constexpr const char* kPlotGrid = "#dddddd";

/// The colour of a curve as #rrggbb, from the eight colours of Okabe and Ito (2008), which most people can
/// distinguish. They repeat.
std::string curve_color(std::size_t index);
/// The same colour as a variable of plot_colors_css.
std::string curve_color_variable(std::size_t index);

/// CSS rules that define the variables of themed_svg for light and for dark pages. The page defines --page
/// and --text.
std::string plot_colors_css();

/// Replaces gnuplot's title and description, and makes the picture one object for screen readers.
std::string described_svg(const std::string& svg, std::string_view title, std::string_view description);

/// Replaces the colours of a plot by the variables of plot_colors_css.
std::string themed_svg(const std::string& svg);

}  // namespace penumbra
