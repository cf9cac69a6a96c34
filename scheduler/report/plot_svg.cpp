#include "scheduler/report/plot_svg.h"

#include <fmt/format.h>

#include <iterator>
#include <optional>

#include "scheduler/files/quoting.h"

namespace penumbra {
namespace {

struct CurveColor {
  const char *light, *dark;
};
constexpr CurveColor kCurveColors[] = {{"#0072b2", "#4aa8e0"}, {"#d55e00", "#f07f2e"}, {"#009e73", "#2cc295"},
                                       {"#cc79a7", "#dd8fba"}, {"#e69f00", "#f0b030"}, {"#56b4e9", "#8fd0f5"},
                                       {"#000000", "#f0f0f0"}, {"#b59f00", "#d8c53a"}};

struct PlotColor {
  const char *name, *light, *dark;
};
constexpr PlotColor kPlotColors[] = {{"--plot-text", kPlotText, "#d6d9de"},
                                     {"--plot-frame", kPlotFrame, "#8b929c"},
                                     {"--plot-guide", kPlotGuide, "#9aa1ab"},
                                     {"--plot-grid", kPlotGrid, "#343a43"}};

/// The variable of a colour that gnuplot wrote as #rrggbb, in any case.
std::optional<std::string> variable_of(std::string color) {
  for (char& c : color) c = c >= 'A' && c <= 'F' ? char(c - 'A' + 'a') : c;
  if (color == "#ffffff") return "--page";
  for (const PlotColor& known : kPlotColors)
    if (color == known.light) return known.name;
  for (std::size_t i = 0; i < std::size(kCurveColors); ++i)
    if (color == kCurveColors[i].light) return curve_color_variable(i);
  return std::nullopt;
}

/// A colour at the beginning of the text: #rrggbb or rgb(r, g, b).
struct FoundColor {
  std::size_t length = 0;
  std::string hex;
};
std::optional<FoundColor> color_at(const std::string& text, std::size_t at) {
  unsigned red = 0, green = 0, blue = 0;
  int end = 0;
  const char* begin = text.c_str() + at;
  if (std::sscanf(begin, "#%2x%2x%2x%n", &red, &green, &blue, &end) == 3 && end == 7)
    return FoundColor{7, std::string(begin, 7)};
  end = 0;
  if (std::sscanf(begin, "rgb(%u ,%u ,%u )%n", &red, &green, &blue, &end) == 3 && end > 0)
    return FoundColor{std::size_t(end), fmt::format("#{:02x}{:02x}{:02x}", red, green, blue)};
  return std::nullopt;
}

}  // namespace

std::string curve_color(std::size_t index) { return kCurveColors[index % std::size(kCurveColors)].light; }

std::string curve_color_variable(std::size_t index) {
  return fmt::format("--curve-{}", index % std::size(kCurveColors));
}

std::string plot_colors_css() {
  std::string light, dark;
  for (const PlotColor& color : kPlotColors) {
    light += fmt::format("{}: {}; ", color.name, color.light);
    dark += fmt::format("{}: {}; ", color.name, color.dark);
  }
  for (std::size_t i = 0; i < std::size(kCurveColors); ++i) {
    light += fmt::format("{}: {}; ", curve_color_variable(i), kCurveColors[i].light);
    dark += fmt::format("{}: {}; ", curve_color_variable(i), kCurveColors[i].dark);
  }
  return fmt::format(":root {{ {}}}\n@media (prefers-color-scheme: dark) {{ :root {{ {}}} }}\n", light, dark);
}

std::string described_svg(const std::string& svg, std::string_view title, std::string_view description) {
  const std::size_t begin = svg.find("<svg"), body = svg.find("<g", begin);
  const std::size_t open = svg.find('>', begin);
  if (begin == std::string::npos || open == std::string::npos || body == std::string::npos || body < open)
    return svg;
  const std::string name = html_escaped(title), text = html_escaped(description);
  return svg.substr(0, open) + fmt::format(" role=\"img\" aria-label=\"{}. {}\"", name, text) +
         fmt::format(">\n<title>{}</title>\n<desc>{}</desc>\n", name, text) + svg.substr(body);
}

std::string themed_svg(const std::string& svg) {
  constexpr std::string_view kBlack = "\"black\"";
  std::string out;
  for (std::size_t at = 0; at < svg.size();) {
    if (svg.compare(at, kBlack.size(), kBlack) == 0) {  // gnuplot's colour of text
      out += "\"var(--plot-text)\"";
      at += kBlack.size();
      continue;
    }
    const bool starts = svg[at] == '#' || svg[at] == 'r';
    const auto color = starts ? color_at(svg, at) : std::nullopt;
    const auto variable = color ? variable_of(color->hex) : std::nullopt;
    if (variable) {
      out += fmt::format("var({})", *variable);
      at += color->length;
    } else {
      out += svg[at++];
    }
  }
  return out;
}

}  // namespace penumbra
