#include "scheduler/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <set>

#include "scheduler/files/quoting.h"
#include "scheduler/report/gnuplot.h"
#include "scheduler/report/plot_axes.h"
#include "scheduler/report/plot_svg.h"
#include "scheduler/report/sampler_orders.h"

namespace penumbra {
namespace {

// In pixels, the height without the legend. So wide that the text has 12 pixels on the screen of a phone,
// and is not much larger than other text on a wide one.
constexpr int kWidth = 460, kHeight = 350;
constexpr int kRowHeight = 22;    // of the legend: 24 pixels times its spacing
constexpr double kClearBias = 3;  // in standard errors
const std::string kGuideStyle = fmt::format("lines lc rgb '{}' lw 1.5 dt (8,6)", kPlotGuide);

constexpr std::string_view kLegendRows = "# rows of the legend: ";

int plot_height(const std::string& script) {
  const bool told = script.starts_with(kLegendRows);
  return kHeight + (told ? kRowHeight * std::atoi(script.c_str() + kLegendRows.size()) : 0);
}

/// Of UTF-8.
std::size_t characters(const std::string& text) {
  return std::size_t(std::ranges::count_if(text, [](unsigned char c) { return (c & 0xc0) != 0x80; }));
}

/// Labels that are too long for the legend lose their middle. The tables hold all of them.
std::string shortened(const std::string& label) {
  constexpr std::size_t kMost = 34, kEnd = 12;
  std::vector<std::size_t> starts;  // of characters
  for (std::size_t i = 0; i < label.size(); ++i)
    if ((static_cast<unsigned char>(label[i]) & 0xc0) != 0x80) starts.push_back(i);
  if (starts.size() <= kMost) return label;
  return label.substr(0, starts[kMost - kEnd - 1]) + "…" + label.substr(starts[starts.size() - kEnd]);
}

struct PlotPoint {
  double x = 0, y = 0;
  double error = NAN;  ///< standard error of y, if known
};

/// Collects the data blocks and plot commands of a script.
class Script {
 public:
  Script(const std::string& x_label, const std::string& y_label) {
    text_ = fmt::format(
        "set logscale xy\nset xlabel {0} offset 0,0.5\nset ylabel {1} offset 1.8\n"
        "set grid xtics ytics lt 1 lc rgb '{4}' lw 1\nset border lc rgb '{3}'\nset bars 0.7\n"
        "set tics textcolor rgb '{2}'\nset lmargin at screen 0.2\nset rmargin at screen 0.97\n",
        gnuplot_quoted(x_label), gnuplot_quoted(y_label), kPlotText, kPlotFrame, kPlotGrid);
  }
  /// Adds commands.
  void text(const std::string& text) { text_ += text; }

  /// Adds a curve with markers, and with error bars where errors are known. Points without a logarithm are
  /// not drawn.
  void add(const std::vector<PlotPoint>& points, const std::string& look, const std::string& title) {
    std::string rows;
    bool bars = false;
    for (const PlotPoint& point : points) {
      if (!(point.x > 0 && point.y > 0) || !std::isfinite(point.y)) continue;
      const double error = std::isfinite(point.error) ? point.error : 0;
      bars = bars || error > 0;
      constexpr double kFarBelow = 1e-9;  // a bar that reaches 0 leaves the plot
      rows += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}\n", point.x, point.y,
                          std::max(point.y - error, kFarBelow * point.y), point.y + error);
    }
    add_rows(rows, bars ? "using 1:2:3:4 with yerrorlines " + look : "using 1:2 with linespoints " + look,
             title);
  }
  void add_line(const std::vector<PlotPoint>& points, const std::string& look, const std::string& title) {
    std::string rows;
    for (const PlotPoint& point : points)
      if (point.x > 0 && point.y > 0) rows += fmt::format("{:.9g} {:.9g}\n", point.x, point.y);
    add_rows(rows, "using 1:2 with " + look, title);
  }
  [[nodiscard]] bool empty() const { return plots_.empty(); }
  /// The legend is above the plot, in as many columns as fit. Its rows increase the height; see plot_height.
  [[nodiscard]] std::string finished() const {
    if (empty()) return "";
    constexpr std::size_t kCharacter = 11, kSample = 100;  // widths in pixels, as gnuplot estimates them
    std::size_t longest = 1;
    for (const std::string& title : titles_) longest = std::max(longest, characters(title));
    const std::size_t columns = std::clamp<std::size_t>(kWidth / (kCharacter * longest + kSample), 1, 3);
    const std::size_t rows = (titles_.size() + columns - 1) / columns;
    const double top = double(kHeight - 14) / double(kHeight + kRowHeight * int(rows));
    return fmt::format(
        "{0}{1}\n{2}set tmargin at screen {3:.4f}\nset bmargin at screen {4:.4f}\n"
        "set key at screen 0.01,{5:.4f} left bottom horizontal samplen 1.6 spacing 0.9 reverse Left maxcols "
        "{6}\n{7}\n",
        kLegendRows, rows, text_, top, 62.0 / double(kHeight + kRowHeight * int(rows)), top + 0.012, columns,
        plots_);
  }

 private:
  void add_rows(const std::string& rows, const std::string& how, const std::string& title) {
    if (rows.empty()) return;
    const std::string name = fmt::format("$d{}", blocks_++);
    text_ += fmt::format("{} << EOD\n{}EOD\n", name, rows);
    titles_.push_back(title);
    plots_ += fmt::format("{}{} {} title {}", plots_.empty() ? "plot " : ", \\\n     ", name, how,
                          gnuplot_quoted(title));
  }

  std::string text_, plots_;
  std::vector<std::string> titles_;
  int blocks_ = 0;
};

/// The axes of a report's plots. All scenes have the same, so that plots of one kind can be compared.
struct PlotRanges {
  AxisRange seconds, relative_mse, mse, split;
  std::set<double> budgets;
};

bool has_clear_bias(const CurvePoint& point) {
  return point.relative.bias_squared > kClearBias * point.relative.bias_squared_error;
}

PlotRanges ranges_of(const ReportData& report) {
  PlotRanges ranges;
  for (const SceneReport& scene : report.scenes)
    for (const ErrorCurve& curve : scene.curves)
      for (const CurvePoint& point : curve.points) {
        if (point.errors.relative_mse > 0) ranges.seconds.include(report.seconds(point.seconds));
        if (point.spp > 0) ranges.budgets.insert(point.spp);
        ranges.relative_mse.include(point.errors.relative_mse);
        ranges.relative_mse.include(point.errors.relative_mse + point.relative_mse_error);
        ranges.mse.include(point.errors.mse);
        ranges.mse.include(point.errors.mse + point.mse_error);
        if (point.spp == 0 || point.images.size() < 2) continue;
        ranges.split.include(point.relative.variance);
        if (has_clear_bias(point)) ranges.split.include(point.relative.bias_squared);
      }
  return ranges;
}

constexpr int kMostXLabels = 6, kMostYLabels = 9;

/// Peers have open symbols, so that they can be distinguished in grey print.
std::string style(const ErrorCurve& curve, std::size_t index) {
  static constexpr int kFilled[] = {7, 5, 9, 11, 13, 15}, kOpen[] = {6, 4, 8, 10, 12, 14};
  const int point = (curve.name.peer ? kOpen : kFilled)[index % 6];
  return fmt::format("lc rgb '{}' lw 2 pt {} ps 0.8{}", curve_color(index), point,
                     curve.name.peer ? " dt 2" : "");
}

std::string slope_text(double slope) {
  return fmt::format("{}{:.2f}", slope < 0 ? "−" : "", std::abs(slope));
}

std::string legend(const ErrorCurve& curve, const Slope& slope) {
  return slope.fit ? fmt::format("{} ({})", shortened(curve.name.label), slope_text(slope.fit->slope))
                   : shortened(curve.name.label);
}

/// error = k / cost, below all points and within the axes.
std::vector<PlotPoint> guide_line(const std::vector<std::vector<PlotPoint>>& curves, const AxisRange& x,
                                  const AxisRange& y) {
  constexpr double kBelow = 0.75;
  double k = INFINITY;
  for (const auto& curve : curves)
    for (const PlotPoint& point : curve)
      if (point.x > 0 && point.y > 0) k = std::min(k, kBelow * point.x * point.y);
  const double begin = std::max(x.low, k / y.high), end = std::min(x.high, k / y.low);
  if (!std::isfinite(k) || !(begin < end)) return {};
  return {{begin, k / begin}, {end, k / end}};
}

/// relMSE of each point of each curve over its cost, which is not positive where there is none.
std::string curves_script(const SceneReport& scene, const std::string& x_label, const std::string& axes,
                          const AxisRange& x, const AxisRange& y,
                          const std::function<double(const CurvePoint&)>& cost, Slope ErrorCurve::*slope) {
  std::vector<std::vector<PlotPoint>> all;
  for (const ErrorCurve& curve : scene.curves) {
    all.emplace_back();
    for (const CurvePoint& point : curve.points)
      all.back().push_back({cost(point), point.errors.relative_mse, point.relative_mse_error});
  }
  Script script(x_label, "relMSE");
  script.text(axes);
  for (std::size_t i = 0; i < all.size(); ++i)
    script.add(all[i], style(scene.curves[i], i), legend(scene.curves[i], scene.curves[i].*slope));
  if (script.empty()) return "";
  script.add_line(guide_line(all, x.widened(), y.widened()), kGuideStyle, "slope −1");
  if (scene.reference.noise_relmse) {
    script.text(fmt::format(
        "set arrow from graph 0, first {0:.6g} to graph 1, first {0:.6g} nohead dt 3 lc rgb '{1}'\n"
        "set label 'noise of the reference' at graph 0.01, first {0:.6g} offset 0,0.5 tc rgb '{2}'\n",
        *scene.reference.noise_relmse, kPlotGuide, kPlotText));
  }
  return script.finished();
}

/// A line of this slope through the first point, over the range of the points.
std::vector<PlotPoint> order_line(const std::vector<PlotPoint>& points, double slope) {
  const auto usable = std::ranges::find_if(points, [](const PlotPoint& p) { return p.x > 0 && p.y > 0; });
  if (usable == points.end()) return {};
  std::vector<PlotPoint> line;
  for (const PlotPoint& point : points)
    line.push_back({point.x, usable->y * std::pow(point.x / usable->x, slope)});
  return line;
}

/// What the plot of relMSE over time shows, as text.
std::string time_description(const ReportData& report, const SceneReport& scene) {
  std::string text = "Both axes are logarithmic.";
  for (const ErrorCurve& curve : scene.curves) {
    if (curve.points.empty()) continue;
    const CurvePoint &first = curve.points.front(), &last = curve.points.back();
    text += fmt::format(" {}: from {:.2g} at {:.2g} s to {:.2g} at {:.2g} s", curve.name.label,
                        first.errors.relative_mse, report.seconds(first.seconds), last.errors.relative_mse,
                        report.seconds(last.seconds));
    const Slope& slope = curve.relmse_over_time;
    text += slope.fit ? fmt::format(", slope {:.2f}.", slope.fit->slope)
                      : ", no slope: " + slope.none_because + ".";
  }
  return text;
}

constexpr const char* kInTables = "Both axes are logarithmic. The values are in the tables of the page.";

}  // namespace

std::string time_plot_script(const ReportData& report, const SceneReport& scene) {
  const PlotRanges ranges = ranges_of(report);
  return curves_script(
      scene, report.total_time ? "total time in seconds" : "render time in seconds",
      axis_script('x', ranges.seconds, kMostXLabels) + axis_script('y', ranges.relative_mse, kMostYLabels),
      ranges.seconds, ranges.relative_mse,
      [&](const CurvePoint& point) { return report.seconds(point.seconds); }, &ErrorCurve::relmse_over_time);
}

std::string spp_plot_script(const ReportData& report, const SceneReport& scene) {
  const PlotRanges ranges = ranges_of(report);
  AxisRange budgets;
  for (const double budget : ranges.budgets) budgets.include(budget);
  return curves_script(
      scene, "samples per pixel",
      budget_axis_script(ranges.budgets) + axis_script('y', ranges.relative_mse, kMostYLabels), budgets,
      ranges.relative_mse, [](const CurvePoint& point) { return double(point.spp); },
      &ErrorCurve::relmse_over_spp);
}

std::string bias_plot_script(const ReportData& report, const SceneReport& scene) {
  const PlotRanges ranges = ranges_of(report);
  Script script("samples per pixel", "relative variance, bias²");
  script.text(budget_axis_script(ranges.budgets) + axis_script('y', ranges.split, kMostYLabels));
  for (std::size_t i = 0; i < scene.curves.size(); ++i) {
    const ErrorCurve& curve = scene.curves[i];
    std::vector<PlotPoint> variance, bias;
    for (const CurvePoint& point : curve.points) {
      if (point.spp == 0 || point.images.size() < 2) continue;
      variance.push_back({double(point.spp), point.relative.variance});
      // A bias that is not clearly larger than its standard error is only known to be small.
      if (has_clear_bias(point))
        bias.push_back({double(point.spp), point.relative.bias_squared, point.relative.bias_squared_error});
    }
    const std::string label = shortened(curve.name.label);
    script.add(variance, style(curve, i), label + ": variance");
    script.add(bias, fmt::format("lc rgb '{}' lw 2 dt 2 pt 2 ps 1.1", curve_color(i)), label + ": bias²");
  }
  return script.finished();
}

std::string sampler_plot_script(const ReportData& report, const SceneReport& scene) {
  std::set<std::string> samplers;
  for (const ErrorCurve& curve : scene.curves) {
    if (!curve.name.peer) samplers.insert(curve.name.sampler);
  }
  if (samplers.size() < 2) return "";
  const PlotRanges ranges = ranges_of(report);
  Script script("samples per pixel", "MSE");
  script.text(budget_axis_script(ranges.budgets) + axis_script('y', ranges.mse, kMostYLabels));
  std::map<double, std::string> orders;  // the samplers with that slope
  for (std::size_t i = 0; i < scene.curves.size(); ++i) {
    const ErrorCurve& curve = scene.curves[i];
    if (curve.name.peer || curve.points.empty()) continue;
    std::vector<PlotPoint> points;
    for (const CurvePoint& point : curve.points)
      points.push_back({double(point.spp), point.errors.mse, point.mse_error});
    script.add(points, style(curve, i), legend(curve, curve.mse_over_spp));
    const auto order = expected_order(curve.name.sampler);
    if (!order) continue;
    for (const double slope : {order->smooth, order->edges}) {
      if (!orders.emplace(slope, curve.name.sampler).second) continue;
      script.add_line(order_line(points, slope), kGuideStyle, fmt::format("expected order {:g}", slope));
    }
  }
  return script.finished();
}

Expected<std::vector<Plot>> draw_plots(const std::filesystem::path& gnuplot,
                                       const std::filesystem::path& folder, const ReportData& report,
                                       const SceneReport& scene) {
  struct Wanted {
    const char *name, *title;
    std::string script, description;
  };
  const Wanted wanted[] = {
      {"time", "Error against time", time_plot_script(report, scene), time_description(report, scene)},
      {"spp", "Error against samples per pixel", spp_plot_script(report, scene), kInTables},
      {"bias", "Bias² and variance", bias_plot_script(report, scene), kInTables},
      {"samplers", "Convergence of samplers", sampler_plot_script(report, scene), kInTables},
  };
  std::vector<Plot> plots;
  for (const Wanted& plot : wanted) {
    if (plot.script.empty()) continue;
    auto drawn = run_gnuplot(gnuplot, folder, scene.name + "-" + plot.name,
                             {.script = plot.script,
                              .title = fmt::format("{}: {}", scene.name, plot.title),
                              .description = plot.description,
                              .width = kWidth,
                              .height = plot_height(plot.script)});
    if (!drawn) return std::unexpected(drawn.error());
    plots.push_back({plot.name, plot.title, std::move(drawn->svg), std::move(drawn->png)});
  }
  return plots;
}

}  // namespace penumbra
